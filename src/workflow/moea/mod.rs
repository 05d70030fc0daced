//! `bench moea`: what the algorithms reach on problems with known fronts, over seeds and budgets.

mod published;
mod run;
mod study;

use serde::Serialize;

pub use super::sample::{Against, Sample, Verdict};
pub use published::{Checkpoint, Published};
pub use run::run;

use crate::moea::{Contender, Operators, benchmark::Benchmark};

/// What to compare.
#[derive(Debug, Clone)]
pub struct Inputs {
    /// Problems, in the order of the findings.
    pub problems: Vec<Benchmark>,
    /// Algorithms, in the order of the findings.
    pub contenders: Vec<Contender>,
    /// Budgets. Each is a run of its own, because NSGA-III-FO fades its focus over the budget.
    pub evaluations: Vec<u64>,
    /// First seed.
    pub first_seed: u64,
    /// Number of seeds, which follow one another.
    pub seeds: u64,
    /// Rates and distribution indices.
    pub operators: Operators,
    /// Steps of the convergence curves, which the runs of the largest budget give; 0 for none.
    pub steps: u64,
    /// Whether to keep every run's front.
    pub fronts: bool,
}

impl Inputs {
    /// Number of runs to make.
    pub fn runs(&self) -> u64 {
        let cells = self.problems.len() * self.contenders.len() * self.evaluations.len();
        self.seeds.saturating_mul(cells as u64)
    }
}

/// What was found.
#[derive(Debug, Clone, PartialEq)]
pub struct Study {
    /// Problems and what they were measured against.
    pub rulers: Vec<Ruler>,
    /// By problem, budget and algorithm.
    pub cells: Vec<Cell>,
    /// Cells won, tied and lost by each algorithm but the baseline.
    pub tallies: Vec<Tally>,
    /// By problem and algorithm.
    pub curves: Vec<Curve>,
    /// By problem, budget, algorithm and seed.
    pub fronts: Vec<Front>,
}

/// What the populations of a problem are measured against.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Ruler {
    /// Its name.
    pub problem: String,
    /// Number of objectives.
    pub objectives: usize,
    /// Number of variables.
    pub variables: usize,
    /// Points of the true front that IGD and IGD+ are measured to.
    pub front_points: usize,
    /// The hypervolume's reference point, `[objectives]`.
    pub reference_point: Vec<f64>,
}

/// One algorithm on one problem with one budget.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Cell {
    /// Name of the problem.
    pub problem: String,
    /// Number of objectives.
    pub objectives: usize,
    /// Budget.
    pub evaluations: u64,
    /// Name of the algorithm.
    pub algorithm: &'static str,
    /// Size of the population at the end.
    pub members: usize,
    /// Number of runs.
    pub seeds: u64,
    /// Inverted generational distance, smaller is better.
    pub igd: Sample,
    /// IGD+, smaller is better.
    pub igd_plus: Sample,
    /// Hypervolume as a share of the box from 0 to the reference point, larger is better.
    pub hypervolume: Sample,
    /// The paper's Table 1.
    pub table_1: Option<Published>,
    /// What the paper says of its Figure 3 here, if this is run as there.
    pub figure_3: Option<Checkpoint>,
}

/// Cells won, tied and lost, in this order.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Tally {
    /// Name of the algorithm.
    pub algorithm: &'static str,
    /// In IGD.
    pub igd: [usize; 3],
    /// In IGD+.
    pub igd_plus: [usize; 3],
    /// In hypervolume.
    pub hypervolume: [usize; 3],
}

/// The course of one algorithm on one problem.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Name of the problem.
    pub problem: String,
    /// Number of objectives.
    pub objectives: usize,
    /// The algorithm.
    pub contender: Contender,
    /// Number of runs.
    pub seeds: u64,
    /// In order of evaluations.
    pub points: Vec<Point>,
}

/// Lower quartile, median and upper quartile of every indicator.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Evaluations made.
    pub evaluations: u64,
    /// Inverted generational distance.
    pub igd: [f64; 3],
    /// IGD+.
    pub igd_plus: [f64; 3],
    /// Hypervolume.
    pub hypervolume: [f64; 3],
}

/// The non-dominated members of a run's last population.
#[derive(Debug, Clone, PartialEq)]
pub struct Front {
    /// Name of the problem.
    pub problem: String,
    /// Name of the algorithm.
    pub algorithm: &'static str,
    /// Budget.
    pub evaluations: u64,
    /// Seed.
    pub seed: u64,
    /// Number of objectives.
    pub objectives: usize,
    /// `[n][objectives]` in one vector.
    pub points: Vec<f64>,
}

/// Name of the algorithm that the others are compared with.
pub const BASELINE: &str = "nsga3";

/// Fewer seeds than this say little.
pub const FEW_SEEDS: u64 = 10;
