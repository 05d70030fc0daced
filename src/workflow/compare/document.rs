//! What a comparison found: the document, as `schemas/compare.v2.schema.json` describes it.

use serde::{Deserialize, Serialize};

use super::{
    Change, Changes, Figures, GateResult, Run, Summary, TransitionPair, Unpaired, Verdict,
    figures::{against, rest_farther},
    summary::overall,
};
use crate::{
    remark::Remarks,
    replay::{Metric, Rules, ToolReplay},
    series::Pair,
};

/// What the format is called.
pub(super) const FORMAT: &str = "hydrotrace.compare.v2";

/// What a change did to the tracking error of a task. Times are seconds since the first sample of a run; positions,
/// errors and speeds of a joint are in its unit, rad or m; errors are planned minus measured, differences after minus
/// before. Values of a side with several runs are their means.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Comparison {
    /// Always "hydrotrace.compare.v2".
    pub format: String,
    /// Name and version of the program that wrote it.
    pub program: String,
    /// The runs before the change.
    pub before: Vec<Run>,
    /// The runs after it.
    pub after: Vec<Run>,
    /// Whether every run after executes the plan of the first run before.
    pub same_plan: bool,
    /// Joints that every run has.
    pub joints: Vec<String>,
    /// What became of the peak error over all paired transitions.
    pub verdict: Verdict,
    /// Every metric over all transitions, over starts from rest if there are reversals too, and by joint.
    pub summaries: Vec<Summary>,
    /// Paired transitions, by joint and time.
    pub pairs: Vec<TransitionPair>,
    /// Transitions that are not found in every run, left out.
    pub unpaired: Vec<Unpaired>,
    /// Whole-run figures of all joints together, then of each.
    pub whole_run: Vec<Figures>,
    /// The figures at the tool, each by its key; null unless every run has the same tool.
    #[serde(default)]
    pub tool: Option<Changes<Metric<ToolReplay>>>,
    /// The limits that were set, each with what was found against it.
    pub gates: Vec<GateResult>,
    /// Whether every limit is kept; if not, the exit code is 4.
    pub gates_kept: bool,
    /// Thresholds and windows used.
    pub rules: Rules,
    /// Doubts about the data or the pairing; any makes the exit code 3.
    pub remarks: Remarks,
    /// The aligned samples of the first run of each side, for plots; not written.
    #[serde(skip)]
    pub samples: [Vec<Pair>; 2],
}

impl Comparison {
    /// The summary of a metric over all transitions; of an arm with both kinds, that of joints that turn and that of
    /// joints that slide.
    pub fn overall(&self, key: &str) -> Vec<&Summary> {
        overall(&self.summaries, key)
    }

    /// Joints whose error over the run grew while that of others fell, the largest growth first.
    pub fn against(&self) -> Vec<(&Figures, Change)> {
        against(&self.whole_run)
    }

    /// Joints that rest farther from their plan than before.
    pub fn rest_farther(&self) -> Vec<(&Figures, Change)> {
        rest_farther(&self.whole_run)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::workflow::compare::{Gates, Inputs, run};

    #[test]
    fn a_document_reads_back_as_it_was_written() {
        let logs = |name: &str| {
            vec![std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("sample-logs").join(name)]
        };
        let gates = [
            "peak-reduction", "p", "transition-growth", "transition-growth-sliding", "rms-ratio",
            "peak-ratio", "tool-error", "end-error",
        ];
        let inputs = Inputs {
            before: logs("panel-install.mcap"),
            after: logs("gaps.mcap"),
            gates: gates.into_iter().fold(Gates::default(), |gates, key| gates.with(key, Some(0.5))),
            ..Inputs::default()
        };
        let document = Comparison { samples: Default::default(), ..run(&inputs).unwrap() };
        let text = crate::document::pretty(&document);
        assert_eq!(serde_json::from_str::<Comparison>(&text).unwrap(), document);
        assert_eq!(document.gates.len(), gates.len());
    }
}
