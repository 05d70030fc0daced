//! Transitions as comma-separated values, SI units.

use std::fmt::Write as _;

use crate::{
    render::{
        kit,
        metric::{csv_cells, csv_columns},
    },
    replay::TRANSITION,
    workflow::report::Report,
};

/// One row a transition, in order of joint and time; remarks follow as lines that start with `#`.
pub(crate) fn csv(report: &Report) -> String {
    let run = report.run.clone().unwrap_or_else(|| report.logs.join(", "));
    let rows = report
        .replay
        .transitions
        .iter()
        .map(|t| std::iter::once(run.clone()).chain(csv_cells(TRANSITION, t)).collect());
    let mut text = kit::csv(std::iter::once("run").chain(csv_columns(TRANSITION)), rows);
    for remark in report.remarks.as_slice() {
        let message = kit::clean(&remark.message);
        let _ = writeln!(text, "# {} x{}: {message}", remark.code.name(), remark.count);
    }
    text
}
