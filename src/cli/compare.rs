//! `compare`: runs the workflow, renders, says what was not kept.

use std::{io::Write, slice::from_ref};

use super::{
    CliError, Outcome,
    args::CompareArgs,
    figures,
    output::{deliver, say_gate, say_remarks, shown, spare_inputs, spare_terminal, text_file},
};
use crate::{
    render::{compare_figures, compare_gate_lines, compare_json, compare_page, compare_parts, markdown},
    workflow::compare::{Inputs, run as compare},
};

/// Pairs listed without `--all`.
const MOST: usize = 15;
/// The same on a page.
const MOST_ON_A_PAGE: usize = 60;

pub(super) fn run(
    args: &CompareArgs,
    out: &mut impl Write,
    err: &mut impl Write,
) -> Result<Outcome, CliError> {
    let before = [from_ref(&args.before), args.more_before.as_slice()].concat();
    let after = [from_ref(&args.after), args.more_after.as_slice()].concat();
    spare_inputs(args.output.as_deref(), &[before.as_slice(), &after].concat())?;
    let output = text_file(args.output.as_deref());
    let format = args.format.or_of(output);
    spare_terminal(format.html, output)?;
    figures::check(&args.figures)?;
    let inputs =
        Inputs { before, after, read: args.read.options(), gates: args.gates.gates(), ..Inputs::default() };
    let comparison = compare(&inputs)?;
    let most = if args.all { usize::MAX } else { MOST };
    let rendered = if format.json {
        compare_json(&comparison)
    } else if format.html {
        compare_page(&comparison, if args.all { usize::MAX } else { MOST_ON_A_PAGE })
    } else if format.markdown {
        markdown(&compare_parts(&comparison, most))
    } else {
        shown(&compare_parts(&comparison, most), output)
    };
    figures::figures(&args.figures, err, || compare_figures(&comparison))?;
    deliver(&rendered, output, out)?;
    if output.is_some() || format.json || format.html {
        say_remarks(&comparison.remarks, err);
    }
    if !comparison.gates_kept() {
        for (line, gate) in compare_gate_lines(&comparison).iter().zip(&comparison.gates) {
            if !gate.kept {
                say_gate(line, err);
            }
        }
        return Ok(Outcome::GateFailed);
    }
    Ok(if comparison.remarks.is_empty() { Outcome::Clean } else { Outcome::Remarks })
}
