//! A task file and the arm that it names.

use std::path::Path;

use super::PlanFailure;
use crate::{
    arm::Arm,
    plan::Setup,
    task::{ArmSource, Task},
};

/// The first task of the paper.
pub const SAMPLE_TASK: &str = include_str!("../../../sample-logs/tasks/task-1.toml");

/// What to plan, as read from a file.
#[derive(Debug, Clone)]
pub struct PlanRequest {
    /// The task.
    pub task: Task,
    /// Its text, to go with the plan.
    pub text: String,
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

    /// Takes a task file's text; reads the arm that it names, from beside `path`.
    ///
    /// # Errors
    ///
    /// [`PlanFailure`] naming file and line.
    pub fn parse(path: &Path, text: String) -> Result<Self, PlanFailure> {
        let named = |source| PlanFailure::Task { path: path.to_owned(), source };
        let task = Task::parse(&text).map_err(named)?;
        let arm = arm_of(&task, path.parent().unwrap_or(Path::new("")))?;
        let setup = Setup::new(&task, arm)
            .map_err(|source| PlanFailure::Setup { path: path.to_owned(), source: Box::new(source) })?;
        Ok(Self { task, text, setup })
    }
}

/// The arm of a task whose files lie in a folder.
///
/// # Errors
///
/// [`PlanFailure`] naming the file.
pub fn arm_of(task: &Task, folder: &Path) -> Result<Arm, PlanFailure> {
    let ArmSource::File { urdf, hydraulics, tool } = &task.arm else { return Ok(Arm::sample()?) };
    let text = read(&folder.join(urdf))?;
    let Some(hydraulics) = hydraulics else {
        return Ok(Arm::without_hydraulics((urdf, &text), tool.as_deref())?);
    };
    let cylinders = read(&folder.join(hydraulics))?;
    Ok(Arm::new((urdf, &text), tool.as_deref(), (hydraulics, &cylinders))?)
}

fn read(path: &Path) -> Result<String, PlanFailure> {
    std::fs::read_to_string(path).map_err(|source| PlanFailure::Read { path: path.to_owned(), source })
}
