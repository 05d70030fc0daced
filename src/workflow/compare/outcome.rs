//! What a comparison found. Field names are those of the JSON report.

use serde::Serialize;

use super::{Figures, GateResult, Measure, Scope, Summary, TransitionPair, Verdict};
use crate::{
    log::SourceInfo,
    remark::Remarks,
    replay::{Kind, Rules},
    series::Pair,
};

/// Before the change or after it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
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
#[derive(Debug, Clone, PartialEq, Serialize)]
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
    /// What is added to a time of the first run before to get the same moment of the plan here, s.
    pub offset_s: f64,
    /// Largest difference of any joint's plan from that of the first run before, at equal times, rad; `None`
    /// where they share too little time.
    pub plan_difference_rad: Option<f64>,
    /// Whether it is the same plan.
    pub same_plan: bool,
}

/// A transition that is not found in every run, and is left out.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Unpaired {
    /// The side it is found on.
    pub side: Side,
    /// The run of that side, from 1.
    pub run: usize,
    /// The joint.
    pub joint: String,
    /// From rest or not.
    pub kind: Kind,
    /// Sign of the planned motion, +1 or -1.
    pub direction: i8,
    /// When its plan starts in that run, s.
    pub planned_onset_s: f64,
    /// Its largest error, rad.
    pub peak_error_rad: f64,
}

/// What a change did, before it is rendered.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// The runs before.
    pub before: Vec<Run>,
    /// The runs after.
    pub after: Vec<Run>,
    /// Joints that every run has.
    pub joints: Vec<String>,
    /// Every measure over all transitions, over starts from rest where there are others, and by joint.
    pub summaries: Vec<Summary>,
    /// Paired transitions, by joint and time.
    pub pairs: Vec<TransitionPair>,
    /// Transitions left out.
    pub unpaired: Vec<Unpaired>,
    /// Whole-run figures of all joints together, then of each.
    pub whole_run: Vec<Figures>,
    /// The limits that were set, each with its outcome.
    pub gates: Vec<GateResult>,
    /// Thresholds and windows used.
    pub rules: Rules,
    /// What was doubtful, in the data or in the pairing.
    pub remarks: Remarks,
    /// The aligned samples of the first run of each side, for plots.
    pub samples: [Vec<Pair>; 2],
}

impl Comparison {
    /// Whether every limit is kept.
    pub fn gates_kept(&self) -> bool {
        self.gates.iter().all(|gate| gate.kept)
    }

    /// The summary of a measure over all transitions.
    pub fn overall(&self, measure: Measure) -> Option<&Summary> {
        self.summaries.iter().find(|s| s.measure == measure && s.scope == Scope::All)
    }

    /// What became of the peak error over all transitions.
    pub fn verdict(&self) -> Verdict {
        self.overall(Measure::PeakError).map_or(Verdict::TooFew, |peak| peak.verdict)
    }

    /// Whether every run after executes the plan of the first run before.
    pub fn same_plan(&self) -> bool {
        self.after.iter().all(|run| run.same_plan)
    }
}
