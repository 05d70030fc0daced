//! What `replan` is asked for.

use std::path::PathBuf;

use super::ReplanFailure;
use crate::{
    fit::Learning,
    log::ReadOptions,
    replay::Rules,
    series::{Series, Track},
    workflow::{
        idle_bound::{self, IdleBound},
        plan::Shaping,
    },
};

/// Largest growth of a plan that may be asked for, as a share.
const MOST_GROWTH: f64 = 10.0;

/// What to plan again, and what may be changed.
#[derive(Debug, Clone)]
pub struct Inputs {
    /// Runs, each a file or a bag directory; the plan is that of the last by their stamps, or here where not all say a date.
    pub logs: Vec<PathBuf>,
    /// What to read of each.
    pub read: ReadOptions,
    /// A file with limits in place of a fit to the runs.
    pub limits: Option<PathBuf>,
    /// The task in place of that in the last log.
    pub task: Option<PathBuf>,
    /// Whether the plan stays as it is.
    pub keep_plan: bool,
    /// Whether a command is made.
    pub precompensate: bool,
    /// Whether other timings are searched though runs of this plan were corrected already: learning starts anew.
    pub retime: bool,
    /// What a new plan is free in beside its times; `None`: the same as the last one.
    pub shape: Option<Shaping>,
    /// How far a command may leave its plan.
    pub learning: Learning,
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
            read: ReadOptions::default(),
            limits: None,
            task: None,
            keep_plan: false,
            precompensate: true,
            retime: false,
            shape: None,
            learning: Learning::default(),
            time_growth: 0.0,
            cost_growth: 0.1,
            evaluations: 20_000,
            seed: 1,
            rules: Rules::default(),
        }
    }
}

impl Inputs {
    pub(super) fn check(&self) -> Result<(), ReplanFailure> {
        if self.keep_plan && !self.precompensate {
            return Err(ReplanFailure::NothingToChange);
        }
        for (key, found) in [("time_growth", self.time_growth), ("cost_growth", self.cost_growth)] {
            if !(0.0..=MOST_GROWTH).contains(&found) {
                return Err(ReplanFailure::Growth { key, found, most: MOST_GROWTH });
            }
        }
        Ok(())
    }

    /// Whether every bound has a joint of the plan to hold.
    pub(super) fn check_bounds(&self, plan: &Series) -> Result<(), IdleBound> {
        let given = [self.learning.most_rad, self.learning.most_m].map(|most| most.is_some());
        let options = ["--max-correction-deg", "--max-correction-mm"];
        idle_bound::check("plan", given, options, &plan.tracks.iter().map(Track::kind))
    }
}
