//! What to plan again.

use std::path::PathBuf;

use crate::{fit::Compensation, replay::Rules, workflow::fit::observe::Wanted};

/// What to plan again, and what may be changed.
#[derive(Debug, Clone)]
pub struct Inputs {
    /// Runs, each a file or a bag directory; the plan is that of the last.
    pub logs: Vec<PathBuf>,
    /// What to read of each.
    pub wanted: Wanted,
    /// A file with limits in place of a fit to the runs.
    pub limits: Option<PathBuf>,
    /// The task in place of that in the last log.
    pub task: Option<PathBuf>,
    /// Whether the plan stays as it is.
    pub keep_plan: bool,
    /// Whether a command is made.
    pub precompensate: bool,
    /// How far a command may leave its plan.
    pub compensation: Compensation,
    /// How much longer the plan may take, as a share.
    pub time_growth: f64,
    /// How much rougher it may be and how much more power it may take, as a share.
    pub cost_growth: f64,
    /// Evaluations of the search.
    pub evaluations: u64,
    /// Seed of the search.
    pub seed: u64,
    /// Thresholds of transitions.
    pub rules: Rules,
}

impl Default for Inputs {
    fn default() -> Self {
        Self {
            logs: Vec::new(),
            wanted: Wanted::default(),
            limits: None,
            task: None,
            keep_plan: false,
            precompensate: true,
            compensation: Compensation::default(),
            time_growth: 0.0,
            cost_growth: 0.1,
            evaluations: 20_000,
            seed: 1,
            rules: Rules::default(),
        }
    }
}
