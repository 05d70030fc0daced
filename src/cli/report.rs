//! `report`: runs the workflow, renders, says what was not kept.

use std::{io::Write, path::Path};

use super::{
    CliError, Outcome,
    args::ReportArgs,
    figures,
    output::{deliver, say_broken, say_remarks, shown, spare_inputs, spare_terminal, text_file},
};
use crate::{
    render::{kit::markdown, report as words},
    workflow::{
        fit::LimitsFile,
        report::{Inputs, Report, run as analyse},
    },
};

/// Transitions listed without `--all`.
const MOST: usize = 15;
/// The same on a page.
const MOST_ON_A_PAGE: usize = 60;

pub(super) fn run(
    args: &ReportArgs,
    out: &mut impl Write,
    err: &mut impl Write,
) -> Result<Outcome, CliError> {
    spare_inputs(args.output.as_deref(), &args.logs)?;
    let output = text_file(args.output.as_deref());
    let format = args.format.or_of(output);
    spare_terminal(format.html, output)?;
    figures::check(&args.figures)?;
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
    let rendered = if format.json {
        words::json(&report)
    } else if format.csv {
        words::csv(&report)
    } else if format.html {
        let limits = args.limits.as_deref().map(|path| limits(path, &report)).transpose()?;
        let fit = limits.as_ref().map(|file| &file.fit);
        words::page(&name, &report, fit, if args.all { usize::MAX } else { MOST_ON_A_PAGE })
    } else if format.markdown {
        markdown(&words::document(&name, &report, most))
    } else {
        shown(&words::document(&name, &report, most), output)
    };
    figures::figures(&args.figures, err, || words::figures(&report))?;
    deliver(&rendered, output, out)?;
    let on_screen = output.is_none() && !format.json && !format.csv && !format.html;
    if !on_screen {
        say_remarks(&report.remarks, err);
    }
    if say_broken(&words::verdicts(&report), err) {
        return Ok(Outcome::GateFailed);
    }
    Ok(if report.remarks.is_empty() { Outcome::Clean } else { Outcome::Remarks })
}

/// The machine for the page, which must be that of the run.
fn limits(path: &Path, report: &Report) -> Result<LimitsFile, CliError> {
    let file = LimitsFile::read(path)?;
    file.check_joints(path, report.pairs.iter().map(|pair| pair.name.as_str()))?;
    Ok(file)
}
