//! A comparison as one JSON document, as `schemas/compare.v1.schema.json` describes it.

use serde::Serialize;

use crate::{
    document,
    remark::Remark,
    replay::Rules,
    workflow::compare::{Comparison, Figures, GateResult, Run, Summary, TransitionPair, Unpaired, Verdict},
};

/// What a change did to the tracking error of a task. Angles are radians, times seconds since the first
/// sample of a run; errors are planned minus measured, differences after minus before. Where a side has
/// several runs, values are their means.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct Document<'a> {
    /// Always "hydrotrace.compare.v1".
    format: &'static str,
    /// Name and version of the program that wrote it.
    program: &'static str,
    /// The runs before the change.
    before: &'a [Run],
    /// The runs after it.
    after: &'a [Run],
    /// Whether every run after executes the plan of the first run before.
    same_plan: bool,
    /// Joints that every run has.
    joints: &'a [String],
    /// What became of the peak error over all paired transitions.
    verdict: Verdict,
    /// Every measure over all transitions, over starts from rest where there are others, and by joint.
    summaries: &'a [Summary],
    /// Paired transitions, by joint and time.
    pairs: &'a [TransitionPair],
    /// Transitions that are not found in every run, left out.
    unpaired: &'a [Unpaired],
    /// Whole-run figures of all joints together, then of each.
    whole_run: &'a [Figures],
    /// The limits that were set, each with what was found against it.
    gates: &'a [GateResult],
    /// Whether every limit is kept; if not, the exit code is 4.
    gates_kept: bool,
    /// Thresholds and windows used.
    rules: &'a Rules,
    /// Doubts about the data or the pairing; any makes the exit code 3.
    remarks: &'a [Remark],
}

/// The comparison, SI units and radians throughout.
pub fn compare_json(comparison: &Comparison) -> String {
    document::pretty(&Document {
        format: "hydrotrace.compare.v1",
        program: document::PROGRAM,
        before: &comparison.before,
        after: &comparison.after,
        same_plan: comparison.same_plan(),
        joints: &comparison.joints,
        verdict: comparison.verdict(),
        summaries: &comparison.summaries,
        pairs: &comparison.pairs,
        unpaired: &comparison.unpaired,
        whole_run: &comparison.whole_run,
        gates: &comparison.gates,
        gates_kept: comparison.gates_kept(),
        rules: &comparison.rules,
        remarks: comparison.remarks.as_slice(),
    })
}

#[cfg(test)]
mod tests {
    use super::Document;

    #[test]
    fn the_committed_schema_is_that_of_the_comparison() {
        crate::schema::is_committed::<Document<'_>>(
            "compare.v1.schema.json",
            "hydrotrace comparison, version 1",
        );
    }
}
