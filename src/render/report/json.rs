//! The report as one JSON document, as `schemas/report.v1.schema.json` describes it.

use serde::Serialize;

use crate::{
    document,
    log::SourceInfo,
    remark::Remark,
    replay::{JointReplay, Rules, Stop, Transition, WholeRun},
    workflow::report::{Alignment, GateResult, Report},
};

/// A tracking-error report of one run. Angles are radians, times seconds since the first sample of
/// the run; errors are planned minus measured.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct Document<'a> {
    /// Always "hydrotrace.report.v1".
    format: &'static str,
    /// Name and version of the program that wrote it.
    program: &'static str,
    /// Where the data come from.
    source: &'a SourceInfo,
    /// How plan and measurement were matched, by joint.
    alignment: &'a [Alignment],
    /// Each joint over the whole run.
    joints: &'a [JointReplay],
    /// Planned starts and reversals, by joint, then time.
    transitions: &'a [Transition],
    /// Dynamic-to-static events, by joint, then time.
    stops: &'a [Stop],
    /// All joints together.
    whole_run: &'a WholeRun,
    /// The limits that were set, each with the worst value found against it.
    gates: &'a [GateResult],
    /// Whether every limit is kept; if not, the exit code is 4.
    gates_kept: bool,
    /// Thresholds and windows used.
    rules: &'a Rules,
    /// Doubts about the data; any makes the exit code 3.
    remarks: &'a [Remark],
}

/// The report, SI units and radians throughout.
pub fn report_json(report: &Report) -> String {
    document::pretty(&Document {
        format: "hydrotrace.report.v1",
        program: document::PROGRAM,
        source: &report.source,
        alignment: &report.alignment,
        joints: &report.replay.joints,
        transitions: &report.replay.transitions,
        stops: &report.replay.stops,
        whole_run: &report.replay.whole_run,
        gates: &report.gates,
        gates_kept: report.gates_kept(),
        rules: &report.replay.rules,
        remarks: report.remarks.as_slice(),
    })
}

#[cfg(test)]
mod tests {
    use super::Document;

    #[test]
    fn the_committed_schema_is_that_of_the_document() {
        crate::schema::is_committed::<Document<'_>>("report.v1.schema.json", "hydrotrace report, version 1");
    }
}
