//! Runs, and a transition in all of them.

use serde::{Deserialize, Serialize};

use super::{change::Changes, pairing::PairedBy};
use crate::{
    log::SourceInfo,
    replay::{Answer, Kind, Metric, Transition},
    series::JointKind,
    workflow::carried::Held,
};

/// Before the change or after it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Side {
    /// Before.
    Before,
    /// After.
    After,
}

impl std::fmt::Display for Side {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(if *self == Self::Before { "before" } else { "after" })
    }
}

/// One run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Run {
    /// Name of its file or folder.
    pub log: String,
    /// Where the data come from.
    pub source: SourceInfo,
    /// Its transitions in the joints compared.
    pub transitions: usize,
    /// From the first planned start to the last planned stop, s.
    pub plan_duration_s: Option<f64>,
    /// From when to when it is compared, s, where the other runs hold less of the plan and of the rests around it; null for
    /// all of it.
    #[serde(default)]
    pub stretch_s: Option<[f64; 2]>,
    /// What is added to a time of the first run before to get the same moment of the plan here, s.
    pub offset_s: f64,
    /// Largest difference of any joint's plan from that of the first run before, at equal times, in the joint's unit;
    /// `None` if they share too little time. Of an arm with both kinds that of joints that turn.
    pub plan_difference: Option<f64>,
    /// The same of joints that slide, m, of an arm with both kinds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub plan_difference_m: Option<f64>,
    /// Whether it is the same plan.
    pub same_plan: bool,
    /// What its command promised, beside what came; null without a promise in the log.
    #[serde(default)]
    pub promised: Option<Held>,
}

/// One transition before and after.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct TransitionPair {
    /// The joint.
    pub joint: String,
    /// The unit of its position: "rad" or "m".
    #[serde(rename = "unit", with = "crate::replay::unit")]
    #[cfg_attr(test, schemars(with = "String"))]
    pub joint_kind: JointKind,
    /// From rest or not.
    pub kind: Kind,
    /// Sign of the planned motion, +1 or -1.
    pub direction: i8,
    /// When the plan starts in the first run before, s.
    pub planned_onset_before_s: f64,
    /// When it starts in the first run after, s.
    pub planned_onset_after_s: f64,
    /// How the two were found to be the same.
    pub paired_by: PairedBy,
    /// What became of the start before; of several runs the worst.
    pub answer_before: Answer,
    /// The same after.
    pub answer_after: Answer,
    /// The metrics that are compared, each by its key.
    #[serde(flatten)]
    pub changes: Changes<Metric<Transition>>,
}

/// A transition before and after, beside what it is in each run.
pub(super) struct Paired<'a> {
    pub(super) pair: TransitionPair,
    /// In the runs before and in those after.
    pub(super) runs: [Vec<&'a Transition>; 2],
}

/// A transition that is not found in every run, and is left out.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Unpaired {
    /// The side it is found on.
    pub side: Side,
    /// The run of that side, from 1.
    pub run: usize,
    /// The joint.
    pub joint: String,
    /// The unit of its position: "rad" or "m".
    #[serde(rename = "unit", with = "crate::replay::unit")]
    #[cfg_attr(test, schemars(with = "String"))]
    pub joint_kind: JointKind,
    /// From rest or not.
    pub kind: Kind,
    /// Sign of the planned motion, +1 or -1.
    pub direction: i8,
    /// When its plan starts in that run, s.
    pub planned_onset_s: f64,
    /// Its largest error, in the joint's unit.
    pub peak_error: f64,
}
