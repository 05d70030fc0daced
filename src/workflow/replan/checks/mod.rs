//! "Safe to send?": what a careful person looks at before a command goes out, each finding with its level, and one verdict.

mod find;
mod supply;

use serde::{Deserialize, Serialize};

use super::{Overall, Replanned};
use crate::{
    fit::{Character, SharedLimit, Supply},
    plan::Limit,
    series::JointKind,
    workflow::{carried::Promise, plan::MarginEntry},
};

/// How a check came out; the worst comes last.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Level {
    /// Nothing speaks against sending.
    Good,
    /// Look at it before sending.
    Caution,
    /// Do not send.
    Stop,
}

/// What follows from all checks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// All checks are good.
    Send,
    /// Half of the correction is wiser; nothing else is in doubt.
    HalfFirst,
    /// Something is to be looked at first.
    CheckFirst,
    /// Something is wrong.
    DoNotSend,
}

/// All checks in the order in which they are read, and what follows from them. Obstacles are not checked.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Checks {
    /// What follows.
    pub verdict: Verdict,
    /// Each check.
    pub list: Vec<Check>,
}

/// One check.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Check {
    /// How it came out.
    pub level: Level,
    /// What was found.
    #[serde(flatten)]
    pub finding: Finding,
}

/// What a check found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(tag = "what", rename_all = "snake_case")]
pub enum Finding {
    /// How far what is sent begins and ends from its plan, largest of all joints, rad.
    Ends {
        /// At the first sample.
        start_rad: f64,
        /// At the last sample.
        end_rad: f64,
    },
    /// Motion at the last sample, largest of all joints.
    Rest {
        /// Speed, rad/s.
        speed_rad_s: f64,
        /// Acceleration, rad/s²; null where nothing is corrected.
        acceleration_rad_s2: Option<f64>,
    },
    /// The limits of task and arm.
    Limits {
        /// Limits that are broken by more than 1 %.
        broken: usize,
        /// Limits that a controller's curve breaks by less, but by more than 0.2 %: the plan lies at them.
        #[serde(default)]
        between: usize,
        /// Of each kind of limit the nearest, most used first; empty without a task.
        nearest: Vec<MarginEntry>,
        /// Kinds that have no limit.
        unlimited: Vec<Limit>,
        /// Kinds that have one and are not checked: samples of a plan tell neither its acceleration exactly nor what it takes.
        #[serde(default)]
        unchecked: Vec<Limit>,
        /// The joint that goes beyond its limit of acceleration by most, as far as samples tell.
        #[serde(default)]
        steep: Option<Steep>,
        /// Without a task: the joint that is sent faster than its plan by most, if it is by half or more.
        #[serde(default)]
        fastest: Option<Fastest>,
        /// Without a task: the joint that is accelerated more than its plan by most, if it is to twice as much or more.
        #[serde(default)]
        sharpest: Option<Sharpest>,
        /// Without a task: the joints that are sent beyond the range of their plan.
        #[serde(default)]
        outside: Vec<Outside>,
    },
    /// A joint whose plan is faster than the joint was found to be.
    TooFast(TooFast),
    /// A plan that asks for more than what its joints share.
    Together {
        /// What they share.
        limit: SharedLimit,
        /// How many times that the plan asks for at most.
        asked: f64,
        /// When, s.
        at_s: f64,
    },
    /// A supply that gave less than joints asked for.
    Supply {
        /// What it gave.
        supply: Supply,
        /// The most that the plan asks the pump for, m³/s; null where cylinders are not known.
        asked_m3_s: Option<f64>,
    },
    /// Nothing was learnt from the newest run.
    Newest {
        /// Its log, and why.
        why: String,
    },
    /// How well each joint is predicted.
    Trust {
        /// By joint of the plan.
        joints: Vec<JointTrust>,
    },
    /// What the last command promised, and what came.
    Promise {
        /// The log of its run.
        log: String,
        /// What was promised.
        promised: Promise,
        /// What came, rad.
        measured_mean_peak_rad: f64,
    },
    /// Mean peak error of starts and reversals.
    Outlook {
        /// Of the last run, rad; null if it has no start.
        last_mean_peak_rad: Option<f64>,
        /// Expected of the next one.
        expected: Promise,
    },
    /// Error over the whole run, starts, stops and rests, beside that of the plan as it is.
    Whole {
        /// Of the last run.
        #[serde(flatten)]
        overall: Overall,
    },
    /// Where the command leaves its plan most.
    Leave {
        /// The joint that does so by most.
        #[serde(flatten)]
        farthest: Left,
        /// The same of the joints of the other kind, where some turn and some slide.
        #[serde(default)]
        also: Option<Left>,
        /// Largest distance of the tool from its plan, m; null without a task.
        tool_m: Option<f64>,
    },
    /// Whether the size of the correction is wise.
    Gain {
        /// Share of the correction that was asked for.
        gain: f64,
        /// Why half of it is wiser; empty if nothing says so.
        reasons: Vec<Reason>,
    },
}

/// A plan that is faster than its joint.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct TooFast {
    /// The joint.
    pub joint: String,
    /// Whether it turns or slides.
    pub kind: JointKind,
    /// Largest speed of its plan, rad/s; of one that slides m/s.
    pub planned_rad_s: f64,
    /// The joint's own, and the highest that it may be in nineteen of twenty cases, rad/s.
    pub limit_rad_s: [f64; 2],
    /// The other joints whose plan is faster than they may be.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub also: Vec<String>,
}

/// A joint that is sent faster than its plan.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Fastest {
    /// The joint.
    pub joint: String,
    /// Whether it turns or slides.
    pub kind: JointKind,
    /// Its largest speed, rad/s; of one that slides m/s.
    pub speed_rad_s: f64,
    /// The same by that of its plan.
    pub ratio: f64,
}

/// A joint that is accelerated more than its plan.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Sharpest {
    /// The joint.
    pub joint: String,
    /// Its largest acceleration by that of its plan.
    pub ratio: f64,
}

/// A joint that leaves its plan.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Left {
    /// The joint.
    pub joint: String,
    /// Whether it turns or slides.
    #[serde(default)]
    pub kind: JointKind,
    /// By how much, rad, m of a joint that slides.
    pub distance_rad: f64,
    /// When, s.
    pub t_s: f64,
}

/// A joint whose samples go beyond its limit of acceleration.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Steep {
    /// The joint.
    pub joint: String,
    /// Whether it turns or slides.
    pub kind: JointKind,
    /// About what it is accelerated to, rad/s², m/s² of a joint that slides.
    pub acceleration_rad_s2: f64,
    /// Its limit.
    pub limit_rad_s2: f64,
}

/// A joint that is sent beyond the range of its plan.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Outside {
    /// The joint.
    pub joint: String,
    /// Whether it turns or slides.
    pub kind: JointKind,
    /// How far it is sent, rad; of one that slides m.
    pub reaches_rad: f64,
    /// By how much that is beyond its plan, rad or m.
    pub beyond_rad: f64,
}

/// How well one joint is predicted.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct JointTrust {
    /// The joint.
    pub joint: String,
    /// What that means.
    pub level: Level,
    /// Whether its command differs from the plan.
    pub corrected: bool,
    /// Share of the squared error that is predicted where it was not fitted; null if the joint was not fitted.
    pub held_out_r2: Option<f64>,
    /// Whether the machine answers as the model does.
    pub model_holds: bool,
    /// Whether its error is more than half of its motion: it does not follow its plan, and is not corrected.
    #[serde(default)]
    pub astray: bool,
    /// Whether it rings or hunts; null without a run of this plan.
    pub character: Option<Character>,
    /// At which frequency, Hz.
    pub frequency_hz: Option<f64>,
}

/// Why half of a correction is wiser.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Reason {
    /// No correction of this plan was sent before.
    FirstCommand,
    /// More error came than the last command promised.
    BrokenPromise,
    /// The machine changed since the last command was made.
    MachineChanged,
}

impl Checks {
    /// Of a plan and command for the next run.
    pub fn of(replanned: &Replanned) -> Self {
        let list: Vec<Check> = find::all(replanned).collect();
        Self { verdict: verdict(&list), list }
    }

    /// Whether half of the correction is to go first, whatever else is to be looked at before.
    pub fn half_first(&self) -> bool {
        // Half of what is not to be sent is not to be sent.
        self.verdict != Verdict::DoNotSend
            && self.at(Level::Caution).any(|check| matches!(check.finding, Finding::Gain { .. }))
    }

    /// Checks that came out so.
    pub fn at(&self, level: Level) -> impl Iterator<Item = &Check> {
        self.list.iter().filter(move |check| check.level == level)
    }
}

fn verdict(list: &[Check]) -> Verdict {
    let half = |check: &&Check| matches!(check.finding, Finding::Gain { .. });
    let doubts = || list.iter().filter(|check| check.level == Level::Caution);
    if list.iter().any(|check| check.level == Level::Stop) {
        Verdict::DoNotSend
    } else if doubts().any(|check| !half(&check)) {
        Verdict::CheckFirst
    } else if doubts().count() > 0 {
        Verdict::HalfFirst
    } else {
        Verdict::Send
    }
}
