//! `compare`: runs the workflow, renders, says what was not kept.

use std::{io::Write, slice::from_ref};

use super::{
    CliError, Outcome,
    args::CompareArgs,
    figures,
    output::{deliver, say_broken, say_remarks, shown, spare_inputs, spare_terminal, text_file},
};
use crate::{
    render::{compare as words, kit::markdown},
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
        words::json(&comparison)
    } else if format.html {
        words::page(&comparison, if args.all { usize::MAX } else { MOST_ON_A_PAGE })
    } else if format.markdown {
        markdown(&words::document(&comparison, most))
    } else {
        shown(&words::document(&comparison, most), output)
    };
    figures::figures(&args.figures, err, || words::figures(&comparison))?;
    deliver(&rendered, output, out)?;
    if output.is_some() || format.json || format.html {
        say_remarks(&comparison.remarks, err);
    }
    if say_broken(&words::verdicts(&comparison), err) {
        return Ok(Outcome::GateFailed);
    }
    Ok(if comparison.remarks.is_empty() { Outcome::Clean } else { Outcome::Remarks })
}
