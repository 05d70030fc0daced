//! The report as one JSON document, as `schemas/report.v1.schema.json` describes it.

use serde::Serialize;

use crate::{
    log::SourceInfo,
    remark::Remark,
    replay::{JointReplay, Rules, Stop, Transition, WholeRun},
    workflow::report::{Alignment, GateResult, Report},
};

#[derive(Serialize)]
struct Document<'a> {
    format: &'static str,
    program: &'static str,
    source: &'a SourceInfo,
    alignment: &'a [Alignment],
    joints: &'a [JointReplay],
    transitions: &'a [Transition],
    stops: &'a [Stop],
    whole_run: &'a WholeRun,
    gates: &'a [GateResult],
    gates_kept: bool,
    rules: &'a Rules,
    remarks: &'a [Remark],
}

/// The report, SI units and radians throughout.
pub fn report_json(report: &Report) -> String {
    pretty(&Document {
        format: "hydrotrace.report.v1",
        program: super::json::PROGRAM,
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

/// Name and version, as written into documents.
pub(super) const PROGRAM: &str = concat!("hydrotrace ", env!("CARGO_PKG_VERSION"));

/// Indented JSON with a final line break; numbers that JSON cannot express become null.
pub(super) fn pretty(document: &impl Serialize) -> String {
    let mut text =
        serde_json::to_string_pretty(document).unwrap_or_else(|error| format!("{{\"error\": \"{error}\"}}"));
    text.push('\n');
    text
}
