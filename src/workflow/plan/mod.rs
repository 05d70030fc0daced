//! `plan`: from a task to a front of plans and the one to run, or from a time vector to its worth.

use std::{
    ops::ControlFlow,
    path::{Path, PathBuf},
};

use thiserror::Error;

mod convergence;
pub mod front;

use crate::{
    arm::{Arm, ArmError},
    plan::{
        Choice, NoChoice, PlanError, PlanEvaluation, Progress, Reference, Rule, Search, Setup, Timing,
        choose, ends, search,
    },
    remark::{Code, Remarks},
    task::{ArmSource, Task, TaskError, Weights},
};
use convergence::Growth;
pub use convergence::Step;

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

/// Why there is no plan.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum PlanFailure {
    /// A file cannot be read.
    #[error("cannot read {}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The file is no task.
    #[error("{} is no task", path.display())]
    Task {
        /// The file.
        path: PathBuf,
        /// Line and reason.
        source: TaskError,
    },
    /// The task does not fit its arm.
    #[error("{} cannot be planned", path.display())]
    Setup {
        /// The file.
        path: PathBuf,
        /// Why.
        source: Box<PlanError>,
    },
    /// The arm's files.
    #[error("the arm cannot be read")]
    Arm(#[from] ArmError),
    /// Times or settings.
    #[error(transparent)]
    Plan(Box<PlanError>),
    /// No timing keeps all limits; what the nearest one breaks.
    #[error("no plan keeps all limits")]
    Infeasible(Box<PlanEvaluation>),
    /// No plan keeps to the ceilings of the task.
    #[error("no plan keeps to the ceilings of the task")]
    Ceilings {
        /// The nearest, which keeps all other limits.
        nearest: Box<PlanEvaluation>,
        /// Its objectives by their ceilings, f1, f2, f3; 0 where there is none.
        share: [f64; 3],
    },
}

impl From<PlanError> for PlanFailure {
    fn from(error: PlanError) -> Self {
        Self::Plan(Box::new(error))
    }
}

/// How to plan.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Options {
    /// How to search.
    pub search: Search,
    /// How to choose; by default the task's weights, or the plan nearest to the ideal.
    pub rule: Option<Rule>,
    /// Weights in place of the task's.
    pub weights: Option<Weights>,
}

/// What was planned.
#[derive(Debug, Clone, PartialEq)]
pub struct Planned {
    /// Names of the joints, base first.
    pub joints: Vec<String>,
    /// Plans of which none is better than another in everything, fastest first.
    pub front: Vec<Timing>,
    /// Their arrivals at the key points, s.
    pub times_s: Vec<Vec<f64>>,
    /// Indices of the best in f1, f2 and f3: A, B and C.
    pub ends: [usize; 3],
    /// A, B and C with all that can be said of them.
    pub best: [PlanEvaluation; 3],
    /// The plan to run.
    pub chosen: PlanEvaluation,
    /// Why it.
    pub choice: Choice,
    /// Evaluations made, those of the choice too.
    pub evaluations: u64,
    /// Generations of the evolution.
    pub generations: u64,
    /// Whether the descent to the fastest plan ended because nothing was left to gain; `None` without descents.
    pub fastest_converged: Option<bool>,
    /// Share of the box between the best of each objective and `BEYOND` times the range of the front
    /// that the front dominates.
    pub hypervolume: f64,
    /// The same on the way, in the box of the final front.
    pub convergence: Vec<Step>,
    /// Doubts about the task.
    pub remarks: Remarks,
}

/// Searches and chooses.
///
/// # Errors
///
/// [`PlanFailure`] if no plan keeps all limits, or none the ceilings, with what comes nearest.
pub fn run(
    request: &PlanRequest,
    options: &Options,
    mut observer: impl FnMut(&Progress<'_>) -> ControlFlow<()>,
) -> Result<Planned, PlanFailure> {
    let PlanRequest { task, setup, .. } = request;
    let mut growth = Growth::default();
    let found = search(setup, &options.search, |progress| {
        growth.see(progress);
        let (phase, evaluations) = (progress.phase, progress.evaluations);
        ::log::debug!("{phase:?}: generation {}, {evaluations} evaluations", progress.generation);
        observer(progress)
    })?;
    ::log::info!(
        "{} plans found in {} evaluations, {} generations",
        found.front.len(),
        found.evaluations,
        found.generations
    );
    let evaluation = |timing: &Timing| PlanEvaluation::of(setup, &setup.times_s(&timing.interval_s));
    let Some(ends) = ends(&found.front) else {
        let nearest =
            found.nearest.ok_or(PlanError::Times { found: 0, expected: setup.interval_count() + 1 })?;
        return Err(PlanFailure::Infeasible(Box::new(evaluation(&nearest)?)));
    };
    let weights = options.weights.or(task.weights);
    let rule = options.rule.unwrap_or(if weights.is_some() { Rule::Weights } else { Rule::Ideal });
    let choice = match choose(setup, &found.front, &task.bounds, (rule, weights)) {
        Ok(choice) => choice,
        Err(NoChoice::Ceilings { nearest, share }) => {
            return Err(PlanFailure::Ceilings { nearest: Box::new(evaluation(&nearest)?), share });
        }
        Err(NoChoice::Empty) => return Err(PlanError::Times { found: 0, expected: 1 }.into()),
    };
    let mut remarks = Remarks::default();
    let weightless = setup.arm().chain.weightless();
    if !weightless.is_empty() && setup.payload_kg().iter().all(|mass_kg| *mass_kg <= 0.0) {
        let message = format!(
            "the arm's file gives no mass to what {} turns: torques and power of nothing",
            weightless.join(", ")
        );
        remarks.add(Code::NoMass, weightless.len() as u64, message);
    }
    let largest = |k: usize| {
        found.front.iter().map(|timing| timing.objectives.as_array()[k]).fold(0.0, |most: f64, f| most.max(f))
    };
    task.bounds.remark_inactive(largest(0), largest(1), largest(2), &mut remarks);
    let objectives = || found.front.iter().map(|timing| timing.objectives.as_array());
    let reference = Reference::of(objectives());
    let hypervolume = reference.measure(objectives());
    let [a, b, c] = ends;
    let best = [evaluation(&found.front[a])?, evaluation(&found.front[b])?, evaluation(&found.front[c])?];
    Ok(Planned {
        joints: setup.joint_names(),
        times_s: found.front.iter().map(|timing| setup.times_s(&timing.interval_s)).collect(),
        ends,
        best,
        chosen: evaluation(&choice.timing)?,
        evaluations: found.evaluations + choice.evaluations,
        generations: found.generations,
        fastest_converged: found.fastest_converged,
        hypervolume,
        convergence: growth.steps(reference, found.evaluations, hypervolume),
        choice,
        front: found.front,
        remarks,
    })
}
