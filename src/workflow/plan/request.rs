//! A task file and the arm that it names.

use std::path::Path;

use super::PlanFailure;
use crate::{
    arm::Arm,
    input_file,
    plan::Setup,
    task::{ArmSource, Task},
};

/// The first task of the paper.
pub const SAMPLE_TASK: &str = include_str!("../../../sample-logs/tasks/task-1.toml");

/// A task and the files of its arm, byte by byte as they were read: what goes with a plan, so that it needs no
/// other file.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct TaskFiles {
    /// The task.
    pub task: String,
    /// The URDF; `None` of the sample arm.
    pub urdf: Option<String>,
    /// Cylinders and pump; `None` of an arm without, or the sample arm.
    pub hydraulics: Option<String>,
}

/// What to plan, as read from a file.
#[derive(Debug, Clone)]
pub struct PlanRequest {
    /// The task.
    pub task: Task,
    /// Its text and the files of its arm, to go with the plan.
    pub files: TaskFiles,
    /// The task on its arm.
    pub setup: Setup,
}

impl PlanRequest {
    /// Reads a task file and the arm that it names.
    ///
    /// # Errors
    ///
    /// [`PlanFailure`] naming file and line.
    pub fn read(path: &Path) -> Result<Self, PlanFailure> {
        Self::parse(path, read(path)?)
    }

    /// The first task of the paper, on the sample arm.
    ///
    /// # Errors
    ///
    /// None but those of a program built wrongly.
    pub fn sample() -> Result<Self, PlanFailure> {
        Self::parse(Path::new("task-1.toml"), SAMPLE_TASK.to_owned())
    }

    /// Whether its arm is the sample arm, the only one that the machines of `simulate` by name have.
    pub fn is_of_sample_arm(&self) -> bool {
        self.files.urdf.is_none()
    }

    /// Takes a task file's text; reads the arm that it names, from beside `path`.
    ///
    /// # Errors
    ///
    /// [`PlanFailure`] naming file and line.
    pub fn parse(path: &Path, text: String) -> Result<Self, PlanFailure> {
        let (mut urdf, mut hydraulics) = (None, None);
        if let ArmSource::File { urdf: arm, hydraulics: cylinders, .. } = parsed(path, &text)?.arm {
            let folder = path.parent().unwrap_or(Path::new(""));
            urdf = Some(read(&folder.join(arm))?);
            hydraulics = cylinders.map(|file| read(&folder.join(file))).transpose()?;
        }
        Self::of(path, TaskFiles { task: text, urdf, hydraulics })
    }

    /// Takes a task and the files of its arm, as a log carries them; reads no other file. `path` is named in errors.
    ///
    /// # Errors
    ///
    /// [`PlanFailure`] naming file and line.
    pub fn of(path: &Path, files: TaskFiles) -> Result<Self, PlanFailure> {
        let task = parsed(path, &files.task)?;
        let arm = files.arm(&task)?;
        let setup = Setup::new(&task, arm)
            .map_err(|source| PlanFailure::Setup { path: path.to_owned(), source: Box::new(source) })?;
        Ok(Self { task, files, setup })
    }
}

impl TaskFiles {
    /// The arm of the task.
    ///
    /// # Errors
    ///
    /// [`PlanFailure`] naming the file.
    pub fn arm(&self, task: &Task) -> Result<Arm, PlanFailure> {
        let ArmSource::File { urdf, hydraulics, tool } = &task.arm else { return Ok(Arm::sample()?) };
        let there = |text: &Option<String>, file: &String| {
            text.clone().ok_or_else(|| PlanFailure::NotCarried { file: file.clone() })
        };
        let text = there(&self.urdf, urdf)?;
        let Some(hydraulics) = hydraulics else {
            return Ok(Arm::without_hydraulics((urdf, &text), tool.as_deref())?);
        };
        let cylinders = there(&self.hydraulics, hydraulics)?;
        Ok(Arm::new((urdf, &text), tool.as_deref(), (hydraulics, &cylinders))?)
    }
}

fn parsed(path: &Path, text: &str) -> Result<Task, PlanFailure> {
    Task::parse(text).map_err(|source| PlanFailure::Task { path: path.to_owned(), source })
}

fn read(path: &Path) -> Result<String, PlanFailure> {
    input_file::read_to_string(path).map_err(|source| PlanFailure::Read { path: path.to_owned(), source })
}
