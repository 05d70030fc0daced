//! What a comparison found.

use super::{
    figures::Figures,
    gates::GateResult,
    pair::{Run, TransitionPair, Unpaired},
    summary::{Scope, Summary, Verdict},
};
use crate::{
    remark::Remarks,
    replay::{PEAK_ERROR, Rules},
    series::Pair,
};

/// What a change did, before it is rendered.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// The runs before.
    pub before: Vec<Run>,
    /// The runs after.
    pub after: Vec<Run>,
    /// Joints that every run has.
    pub joints: Vec<String>,
    /// Every metric over all transitions, over starts from rest if there are reversals too, and by joint.
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

    /// The summary of a metric over all transitions.
    pub fn overall(&self, key: &str) -> Option<&Summary> {
        self.summaries.iter().find(|s| s.measure.key == key && s.scope == Scope::All)
    }

    /// What became of the peak error over all transitions.
    pub fn verdict(&self) -> Verdict {
        self.overall(PEAK_ERROR).map_or(Verdict::TooFew, |peak| peak.verdict)
    }

    /// Whether every run after executes the plan of the first run before.
    pub fn same_plan(&self) -> bool {
        self.after.iter().all(|run| run.same_plan)
    }
}
