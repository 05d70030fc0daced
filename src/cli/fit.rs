//! `fit`: fits, renders, writes the limits.

use std::io::Write;

use super::{
    CliError, Outcome,
    args::FitArgs,
    output::{deliver, say_remarks, shown, spare_inputs, spare_stdout},
};
use crate::{
    render::{fit as words, next},
    workflow::fit::{FitDocument, Fitted, Inputs, LimitsFile, run as fit},
};

pub(super) fn run(args: &FitArgs, out: &mut impl Write, err: &mut impl Write) -> Result<Outcome, CliError> {
    let fitted = fitted(args)?;
    let json = args.json || args.document().is_some();
    let rendered = match &args.output {
        _ if json => FitDocument::of(&fitted).json(),
        Some(path) => {
            let log = fitted.with_task.map_or(args.logs.last(), |place| args.logs.get(place));
            shown(&words::document(&fitted).with_above_remarks(next::limits_written(path, log)), None)
        }
        None => shown(&words::document(&fitted), None),
    };
    deliver(&rendered, args.document(), out)?;
    if json {
        say_remarks(&fitted.remarks, err);
    }
    Ok(if fitted.remarks.is_empty() { Outcome::Clean } else { Outcome::Remarks })
}

/// Fits the runs and writes the limits.
pub(super) fn fitted(args: &FitArgs) -> Result<Fitted, CliError> {
    spare_inputs(args.output.as_deref(), &args.logs)?;
    spare_stdout(args.output.as_deref())?;
    let fitted = fit(&Inputs { logs: args.logs.clone(), read: args.sent.options() })?;
    if let Some(path) = args.output.as_deref().filter(|_| args.document().is_none()) {
        deliver(&LimitsFile::of(&fitted).toml()?, Some(path), &mut std::io::sink())?;
    }
    Ok(fitted)
}
