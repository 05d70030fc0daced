//! `plan`: from a task to a front of plans and the one to run, or from a time vector to its worth.

use std::{
    ops::ControlFlow,
    path::{Path, PathBuf},
};

use thiserror::Error;

mod convergence;
pub mod front;
mod sampled_motion;

use crate::{
    arm::{Arm, ArmError},
    moea::indicator::hypervolume,
    plan::{
        Choice, Evaluator, Margin, NoChoice, Objectives, PlanError, Progress, Rule, Search, Setup, Timing,
        choose, ends, excess, search,
    },
    remark::{Code, Remarks},
    task::{ArmSource, Task, TaskError, Weights},
};
use convergence::Growth;
pub use convergence::Step;
pub use sampled_motion::Course;

/// The first task of the paper.
pub const SAMPLE_TASK: &str = include_str!("../../../sample-logs/tasks/task-1.toml");

/// What to plan, as read from a file.
#[derive(Debug, Clone)]
pub struct Order {
    /// The task.
    pub task: Task,
    /// Its text, to go with the plan.
    pub text: String,
    /// The task on its arm.
    pub setup: Setup,
}

impl Order {
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
    Infeasible(Box<Judged>),
    /// No plan keeps to the ceilings of the task.
    #[error("no plan keeps to the ceilings of the task")]
    Ceilings {
        /// The nearest, which keeps all other limits.
        nearest: Box<Judged>,
        /// Its objectives by their ceilings, f1, f2, f3; 0 where there is none.
        share: [f64; 3],
    },
}

impl From<PlanError> for PlanFailure {
    fn from(error: PlanError) -> Self {
        Self::Plan(Box::new(error))
    }
}

/// A plan, with all that can be said of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Judged {
    /// Arrival at each key point, s, dwells counted.
    pub times_s: Vec<f64>,
    /// Time of movement from each key point to the next, s.
    pub interval_s: Vec<f64>,
    /// What it costs.
    pub objectives: Objectives,
    /// Sum of what it exceeds its limits by, as shares of them; 0 if all hold.
    pub violation: f64,
    /// Root mean square jerk by joint, rad/s³.
    pub rms_jerk_rad_s3: Vec<f64>,
    /// Root mean square power by joint, W.
    pub rms_power_w: Vec<f64>,
    /// Work that the joints do and take up, J.
    pub energy_j: f64,
    /// Every limit, with where the plan comes nearest to it.
    pub margins: Vec<Margin>,
}

impl Judged {
    /// Judges arrivals at the key points, s.
    ///
    /// # Errors
    ///
    /// [`PlanError`] if they are no times for this task.
    pub fn of(setup: &Setup, times_s: &[f64]) -> Result<Self, PlanError> {
        let motion = setup.motion(times_s)?;
        let mut evaluator = Evaluator::new(setup);
        let interval_s = setup.intervals_s(times_s)?;
        // The motion above is of the same times, so there is one.
        let objectives =
            evaluator.evaluate(setup, &interval_s).unwrap_or(Objectives::from_array([f64::INFINITY; 3]));
        let rms_jerk_rad_s3 = evaluator.rms_jerk_rad_s3().to_vec();
        let (rms_power_w, energy_j) = (evaluator.rms_power_w(), evaluator.energy_j());
        let margins = setup.margins(&motion, &mut evaluator);
        let broken = margins.iter().filter(|margin| margin.broken());
        // A sum of nothing would be minus zero.
        let violation = broken.fold(0.0, |sum, margin| sum + excess(margin.share));
        let times_s = times_s.to_vec();
        Ok(Self {
            times_s,
            interval_s,
            objectives,
            violation,
            rms_jerk_rad_s3,
            rms_power_w,
            energy_j,
            margins,
        })
    }

    /// Limits that are broken, the worst first.
    pub fn broken(&self) -> Vec<&Margin> {
        let mut broken: Vec<&Margin> = self.margins.iter().filter(|margin| margin.broken()).collect();
        broken.sort_by(|a, b| b.share.total_cmp(&a.share));
        broken
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
    pub best: [Judged; 3],
    /// The plan to run.
    pub chosen: Judged,
    /// Why it.
    pub choice: Choice,
    /// Evaluations made, those of the choice too.
    pub evaluations: u64,
    /// Generations of the evolution.
    pub generations: u64,
    /// Whether more evaluations would find a faster plan than the fastest; `None` without descents.
    pub hasty: Option<bool>,
    /// Share of the box between the best of each objective and `BEYOND` times the range of the front
    /// that the front dominates.
    pub hypervolume: f64,
    /// The same on the way, in the box of the final front.
    pub convergence: Vec<Step>,
    /// Doubts about the task.
    pub remarks: Remarks,
}

/// How far beyond the range of a front the hypervolume's reference point lies.
pub const BEYOND: f64 = 1.1;

/// Searches and chooses.
///
/// # Errors
///
/// [`PlanFailure`] if no plan keeps all limits, or none the ceilings, with what comes nearest.
pub fn run(
    order: &Order,
    options: &Options,
    mut observer: impl FnMut(&Progress<'_>) -> ControlFlow<()>,
) -> Result<Planned, PlanFailure> {
    let Order { task, setup, .. } = order;
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
    let judged = |timing: &Timing| Judged::of(setup, &setup.times_s(&timing.interval_s));
    let Some(ends) = ends(&found.front) else {
        let nearest =
            found.nearest.ok_or(PlanError::Times { found: 0, expected: setup.interval_count() + 1 })?;
        return Err(PlanFailure::Infeasible(Box::new(judged(&nearest)?)));
    };
    let weights = options.weights.or(task.weights);
    let rule = options.rule.unwrap_or(if weights.is_some() { Rule::Weights } else { Rule::Ideal });
    let choice = match choose(setup, &found.front, &task.bounds, (rule, weights)) {
        Ok(choice) => choice,
        Err(NoChoice::Ceilings { nearest, share }) => {
            return Err(PlanFailure::Ceilings { nearest: Box::new(judged(&nearest)?), share });
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
    let gauge = Gauge::of(objectives());
    let hypervolume = gauge.measure(objectives());
    let [a, b, c] = ends;
    let best = [judged(&found.front[a])?, judged(&found.front[b])?, judged(&found.front[c])?];
    Ok(Planned {
        joints: setup.joint_names(),
        times_s: found.front.iter().map(|timing| setup.times_s(&timing.interval_s)).collect(),
        ends,
        best,
        chosen: judged(&choice.timing)?,
        evaluations: found.evaluations + choice.evaluations,
        generations: found.generations,
        hasty: found.hasty,
        hypervolume,
        convergence: growth.steps(gauge, found.evaluations, hypervolume),
        choice,
        front: found.front,
        remarks,
    })
}

/// A box that hypervolumes are measured in, fixed by the first front seen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gauge {
    ideal: [f64; 3],
    range: [f64; 3],
}

impl Gauge {
    /// From the best of each objective to [`BEYOND`] times the range of these objectives.
    pub fn of(front: impl Iterator<Item = [f64; 3]>) -> Self {
        let (mut ideal, mut worst) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for f in front {
            for k in 0..3 {
                ideal[k] = ideal[k].min(f[k]);
                worst[k] = worst[k].max(f[k]);
            }
        }
        Self { ideal, range: std::array::from_fn(|k| (worst[k] - ideal[k]).max(f64::MIN_POSITIVE)) }
    }

    /// The corner of the best.
    pub fn ideal(&self) -> [f64; 3] {
        self.ideal
    }

    /// The corner that hypervolumes are measured from.
    pub fn reference_point(&self) -> [f64; 3] {
        std::array::from_fn(|k| self.ideal[k] + BEYOND * self.range[k])
    }

    /// Share of the box that a front dominates.
    pub fn measure(&self, front: impl Iterator<Item = [f64; 3]>) -> f64 {
        let scaled: Vec<f64> = front
            .flat_map(|f| (0..3).map(move |k| (f[k] - self.ideal[k]) / self.range[k] / BEYOND))
            .collect();
        hypervolume(&scaled, &[1.0; 3])
    }
}
