//! `report`: runs the workflow, renders, says what was not kept.

use std::io::Write;

use super::{
    CliError, Outcome,
    args::ReportArgs,
    output::{deliver, say_gate, say_remarks, shown, spare_inputs},
};
use crate::{
    report::{gate_lines, markdown, report_json, report_parts, transitions_csv},
    workflow::report::{Inputs, run as analyse},
};

/// Transitions listed without `--all`.
const MOST: usize = 15;

pub(super) fn run(
    args: &ReportArgs,
    out: &mut impl Write,
    err: &mut impl Write,
) -> Result<Outcome, CliError> {
    spare_inputs(args.output.as_deref(), &args.logs)?;
    let inputs = Inputs {
        logs: args.logs.clone(),
        read: args.read.options(),
        gates: args.gates.gates(),
        ..Inputs::default()
    };
    let report = analyse(&inputs)?;
    let name = args.logs.iter().filter_map(|p| p.file_name()).map(|n| n.to_string_lossy().into_owned());
    let name = name.collect::<Vec<_>>().join(", ");
    let most = if args.all { usize::MAX } else { MOST };
    let rendered = if args.format.json {
        report_json(&report)
    } else if args.format.csv {
        transitions_csv(&report)
    } else if args.format.markdown {
        markdown(&report_parts(&name, &report, most))
    } else {
        shown(&report_parts(&name, &report, most), args.output.as_deref())
    };
    deliver(&rendered, args.output.as_deref(), out)?;
    let on_screen = args.output.is_none() && !args.format.json && !args.format.csv;
    if !on_screen {
        say_remarks(&report.remarks, err);
    }
    if !report.gates_kept() {
        for (line, gate) in gate_lines(&report).iter().zip(&report.gates) {
            if !gate.kept {
                say_gate(line, err);
            }
        }
        return Ok(Outcome::GateFailed);
    }
    Ok(if report.remarks.is_empty() { Outcome::Clean } else { Outcome::Remarks })
}
