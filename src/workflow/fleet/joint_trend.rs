//! The trend of one metric of one joint, and the levels that it is of.

use serde::{Deserialize, Serialize};

use super::{
    course::{Change, Course},
    history::By,
    own_change::OwnLevels,
    run::date,
    stepped::LevelStep,
};

/// Runs of one plan, at least: fewer cannot prove a trend.
pub(super) const FEWEST_RUNS: usize = 5;

/// Runs on either side of a change that tell what it is, at least.
pub(super) const FEWEST_OF_A_SIDE: usize = 3;

/// False discoveries among what is found, at most.
pub(super) const MOST_FALSE: f64 = 0.05;

/// The trend of one metric of one joint.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct JointTrend {
    /// The machine.
    pub machine: String,
    /// The joint.
    pub joint: String,
    /// The direction, 1 or -1, of the starts that it is of, where those of the other do not change alike; absent of both.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub direction: Option<i8>,
    /// What was measured.
    pub metric: By,
    /// Its unit: "s" of delays and lags, else that of the joint, "rad" or "m".
    pub unit: String,
    /// Change a day from [`Self::since`] on, median over the starts of each start's Theil-Sen slope, weighted by one over the square of
    /// its scatter; with [`Self::changes`] that of the last stretch.
    pub slope_per_day: f64,
    /// Its 95 % interval, by Kendall's test on the levels of the runs.
    pub interval_95: [f64; 2],
    /// Two-sided probability of such an order of runs by chance.
    pub p_value: f64,
    /// The same, corrected for the number of machines, joints and metrics (false-discovery rate).
    pub q_value: f64,
    /// Whether a change is found, as a trend or as a step: q below the false-discovery rate, 2 % of the level or more, and three
    /// robust standard deviations or more from what is usual where ten joints or more tell that.
    pub found: bool,
    /// Whether what is found is a step, which leaves less of the levels unexplained than the trend does.
    #[serde(default)]
    pub is_step: bool,
    /// The step that explains the levels best; null for fewer than six runs.
    #[serde(default)]
    pub step: Option<LevelStep>,
    /// What the level did, where it changed more than once or from some day on, in order; empty where one trend or one step says it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub changes: Vec<Change>,
    /// That as a line: days since 1970 and level.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub line: Vec<[f64; 2]>,
    /// Whether what the other machines did at the same time is taken off the levels.
    #[serde(default)]
    pub less_common: bool,
    /// By how much a day the other machines changed alike, which is taken off; null where that is not known, or may be chance.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shared_per_day: Option<f64>,
    /// From the day on that it begins to the last run, days: those that the slope is of.
    #[serde(default)]
    pub changing_days: f64,
    /// What the level did, before it is judged.
    #[serde(skip)]
    pub(super) course: Option<Course>,
    /// Its own levels, where what the other machines did is taken off those that are judged.
    #[serde(skip)]
    pub(super) own: OwnLevels,
    /// The first runs of other plans, days since 1970, where nothing tells whether the level changed with the plan.
    #[serde(skip)]
    pub(super) untold: Vec<f64>,
    /// The slope in robust standard deviations of the slopes of this metric in all joints; null where these are equal.
    pub stands_out: Option<f64>,
    /// When the level begins to change, UTC: of a step the first run after it, else the first run if it changes all the time.
    pub since: Option<String>,
    /// Starts that were followed from run to run.
    pub starts: usize,
    /// Runs with such starts, those of a day as one where there are days enough.
    pub runs: usize,
    /// From the first run to the last, days.
    pub days: f64,
    /// Median over the starts at the level of the first three runs.
    pub level: f64,
    /// The level of each run, in the order of time; only of trends that are found.
    pub levels: Vec<Level>,
}

impl JointTrend {
    /// The joint, and the direction where it is of one: `boom +`.
    pub fn joint_and_direction(&self) -> String {
        match self.direction {
            None => self.joint.clone(),
            Some(direction) => format!("{} {}", self.joint, if direction > 0 { "+" } else { "-" }),
        }
    }

    /// Whether the level changes from the first run on, as far as its runs tell.
    pub fn changes_throughout(&self) -> bool {
        let first = self.levels.first().and_then(|level| date(level.at_days));
        !self.is_step && first.is_some() && self.since == first
    }

    /// Growth a day: of a step that from the last run before it to the first run after it, taken as a day at least.
    pub fn growth_per_day(&self) -> f64 {
        let step = self.step.as_ref().filter(|_| self.is_step);
        step.map_or(self.slope_per_day, |step| step.change / step.days.max(1.0))
    }
}

/// What the starts of a joint were like in one run, each start's own level taken off and their median put back.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Level {
    /// When the run began, days since 1970.
    pub at_days: f64,
    /// In the unit of the trend.
    pub value: f64,
    /// The log of the run.
    pub log: String,
    /// The page that lies beside the log under its name, where there is one: `run.html` beside `run.mcap`.
    pub page: Option<String>,
}
