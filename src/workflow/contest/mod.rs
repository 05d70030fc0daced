//! `bench plan`: what the algorithms reach on tasks of the arm (the paper's Figure 5), and the paper's
//! plans beside ours (Table 3).

mod published;
mod run;
mod study;
mod subject;

use serde::Serialize;
use thiserror::Error;

pub use super::sample::{Against, Sample, Verdict};
pub use published::{Printed, Row, Table3, Whose};
pub use run::run;
pub use subject::{Subject, TASKS};

use super::plan::PlanFailure;
use crate::{
    moea::{Algorithm, Contender, MoeaError},
    plan::PlanError,
};

/// What to compare.
#[derive(Debug, Clone)]
pub struct Inputs {
    /// Tasks, in the order of the findings.
    pub subjects: Vec<Subject>,
    /// Algorithms that start from random plans, in the order of the findings; [`SEEDED`] follows them.
    pub contenders: Vec<Contender>,
    /// Budgets. Each is a run of its own, because NSGA-III-FO fades its focus over the budget.
    pub evaluations: Vec<u64>,
    /// First seed.
    pub first_seed: u64,
    /// Number of seeds, which follow one another.
    pub seeds: u64,
    /// Evaluations of the search for the reference front.
    pub reference_evaluations: u64,
    /// Steps of the convergence curves, which the runs of the largest budget give; 0 for none.
    pub steps: u64,
}

impl Inputs {
    /// Number of searches to make, those for the reference fronts included.
    pub fn searches(&self) -> u64 {
        let cells = self.subjects.len() * (self.contenders.len() + 1) * self.evaluations.len();
        self.seeds.saturating_mul(cells as u64).saturating_add(self.subjects.len() as u64)
    }
}

/// A search by a name.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Entrant {
    /// As written to files.
    pub name: &'static str,
    /// As in pictures.
    pub title: &'static str,
    /// The evolutionary algorithm.
    pub algorithm: Algorithm,
    /// Whether it starts from descents and ends with them.
    pub seeded: bool,
}

/// The search that `plan` makes unless told otherwise.
pub const SEEDED: Entrant = Entrant {
    name: "seeded",
    title: "NSGA-III-FO with descents",
    algorithm: Algorithm::NSGA3_FO,
    seeded: true,
};

impl From<Contender> for Entrant {
    fn from(Contender { name, title, algorithm }: Contender) -> Self {
        Self { name, title, algorithm, seeded: false }
    }
}

/// What was found.
#[derive(Debug, Clone, PartialEq)]
pub struct Study {
    /// Tasks and what they were measured against.
    pub rulers: Vec<Ruler>,
    /// By task, budget and algorithm.
    pub cells: Vec<Cell>,
    /// Cells won, tied and lost by each algorithm but the baseline.
    pub tallies: Vec<Tally>,
    /// The paper's Table 3, if its task was among the subjects.
    pub table_3: Option<Table3>,
    /// By task and algorithm.
    pub curves: Vec<Curve>,
}

/// What the plans of a task are measured against: the front of one long seeded search.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Ruler {
    /// Name of the task.
    pub task: String,
    /// Intervals between key points: the variables.
    pub intervals: usize,
    /// Evaluations that the reference front took.
    pub evaluations: u64,
    /// Its plans.
    pub plans: usize,
    /// Its best of each objective: the box begins here, and the ends of the reference front are these.
    pub ideal: [f64; 3],
    /// The hypervolume's reference point: the box ends here.
    pub reference_point: [f64; 3],
    /// Hypervolume of the reference front as a share of the box.
    pub hypervolume: f64,
    /// Share of feasible plans in the first, random population: quartiles over the seeds.
    pub feasible_at_first: [f64; 3],
}

/// One algorithm on one task with one budget.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Cell {
    /// Name of the task.
    pub task: String,
    /// Budget.
    pub evaluations: u64,
    /// Name of the algorithm.
    pub algorithm: &'static str,
    /// Most evaluations that a run made.
    pub made: u64,
    /// Most plans that a run's hypervolume was measured of.
    pub members: usize,
    /// Number of runs.
    pub seeds: u64,
    /// Runs that found a feasible plan.
    pub feasible: u64,
    /// Hypervolume of the last population, or of as many plans spread evenly over a seeded front, as a
    /// share of the box; larger is better.
    pub hypervolume: Sample,
    /// The same of all that a run found, at most as many plans as `plan` hands over.
    pub of_all: Sample,
    /// Median of the latter as a share of the reference front's hypervolume.
    pub share: f64,
    /// Duration of the fastest plan, s; infinite where a run has none.
    pub fastest_s: Sample,
    /// Root mean square jerk of the smoothest plan, rad/s³; infinite where a run has none.
    pub smoothest_rad_s3: Sample,
}

/// Cells won, tied and lost, in this order.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Tally {
    /// Name of the algorithm.
    pub algorithm: &'static str,
    /// In hypervolume of the last population.
    pub hypervolume: [usize; 3],
    /// In hypervolume of all found.
    pub of_all: [usize; 3],
    /// In the fastest plan.
    pub fastest: [usize; 3],
    /// In the smoothest plan.
    pub smoothest: [usize; 3],
}

/// The course of one algorithm on one task.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Name of the task.
    pub task: String,
    /// The algorithm.
    pub entrant: Entrant,
    /// Number of runs.
    pub seeds: u64,
    /// Hypervolume of the reference front.
    pub reference: f64,
    /// In order of evaluations.
    pub points: Vec<Point>,
}

/// Lower quartile, median and upper quartile of both hypervolumes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Evaluations made.
    pub evaluations: u64,
    /// As [`Cell::hypervolume`].
    pub hypervolume: [f64; 3],
    /// As [`Cell::of_all`].
    pub of_all: [f64; 3],
}

/// Why nothing was compared.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ContestFailure {
    /// A name that is no task and no file.
    #[error("{name} is neither {} nor a task file that can be read", known())]
    Unknown {
        /// What was given.
        name: String,
        /// Why the file cannot be read.
        source: std::io::Error,
    },
    /// A task file that cannot be planned.
    #[error(transparent)]
    Task(#[from] PlanFailure),
    /// No timing keeps all limits.
    #[error("{task}: no plan keeps all limits; `hydrotrace plan` says which ones bind")]
    NoPlan {
        /// Name of the task.
        task: String,
    },
    /// Times or settings.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// Settings of an algorithm.
    #[error(transparent)]
    Moea(#[from] MoeaError),
}

fn known() -> String {
    TASKS.map(|(name, _)| name).join(", ")
}

/// Name of the algorithm that the others are compared with.
pub const BASELINE: &str = "nsga3";

/// Plans of the reference front at most.
pub const REFERENCE_PLANS: usize = 1500;

/// Plans that a hypervolume is measured of at most: the members of the populations compared.
pub const MEASURED_PLANS: usize = 92;
