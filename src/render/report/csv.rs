//! Transitions as comma-separated values, SI units.

use std::fmt::Write as _;

use crate::{
    render::{
        kit,
        metric::{csv_cells, csv_columns},
    },
    replay::{TOOL, TRANSITION},
    workflow::report::Report,
};

/// One row a transition, in order of joint and time; figures at the tool and remarks follow as lines that start with `#`.
pub(crate) fn csv(report: &Report) -> String {
    let run = report.run.clone().unwrap_or_else(|| report.logs.join(", "));
    let rows = report
        .replay
        .transitions
        .iter()
        .map(|t| std::iter::once(run.clone()).chain(csv_cells(TRANSITION, t)).collect());
    let mut text = kit::csv(std::iter::once("run").chain(csv_columns(TRANSITION)), rows);
    if let Some(tool) = report.tool.found() {
        for (key, cell) in csv_columns(TOOL).zip(csv_cells(TOOL, tool)) {
            let _ = writeln!(text, "# tool {key} {cell}");
        }
    }
    for remark in report.remarks.as_slice() {
        let message = kit::clean(&remark.message);
        let _ = writeln!(text, "# {} x{}: {message}", remark.code.name(), remark.count);
    }
    text
}
