//! `replan`: plans again, renders, writes the log.

use std::{
    collections::BTreeMap,
    io::Write,
    ops::ControlFlow,
    path::{Path, PathBuf},
};

use super::{
    CliError, Outcome,
    args::ReplanArgs,
    output::{deliver, progress, say_remarks, shown, spare_inputs, spare_stdout},
};
use crate::{
    atomic_file::write_atomically,
    render::{next, replan as words},
    workflow::replan::{Inputs, ReplanDocument, Replanned, run as replan},
};

/// Samples a second in the log; those of the loops that commands are sent to.
const RATE_HZ: f64 = 100.0;

pub(super) fn run(
    args: &ReplanArgs,
    out: &mut impl Write,
    err: &mut impl Write,
) -> Result<Outcome, CliError> {
    let replanned = replanned(args)?;
    let rendered = match &args.output {
        _ if args.json => ReplanDocument::of(&replanned).json(),
        Some(path) => {
            shown(&words::document(&replanned).with_above_remarks(next::next_written(path, &args.logs)), None)
        }
        None => shown(&words::document(&replanned), None),
    };
    deliver(&rendered, None, out)?;
    if args.json {
        say_remarks(&replanned.remarks, err);
    }
    Ok(if replanned.remarks.is_empty() { Outcome::Clean } else { Outcome::Remarks })
}

/// Plans again with a progress bar, and writes plan and command.
pub(super) fn replanned(args: &ReplanArgs) -> Result<Replanned, CliError> {
    let inputs = args.inputs();
    let read: Vec<PathBuf> = args.logs.iter().chain(&args.limits).chain(&args.task).cloned().collect();
    spare_inputs(args.output.as_deref(), &read)?;
    spare_stdout(args.output.as_deref())?;
    let bar = progress(Some(inputs.evaluations), "{bar:30} {pos} evaluations");
    let replanned = replan(&inputs, |evaluations| {
        bar.set_position(evaluations);
        ControlFlow::Continue(())
    });
    bar.finish_and_clear();
    let replanned = replanned?;
    if let Some(path) = &args.output {
        write_log(&inputs, &replanned, path)?;
    }
    Ok(replanned)
}

/// Writes plan and command.
fn write_log(inputs: &Inputs, replanned: &Replanned, path: &Path) -> Result<(), CliError> {
    let provenance = BTreeMap::from(
        [
            ("fitted_to", replanned.fitted_to.join(", ")),
            ("retimed", replanned.retimed.to_string()),
            ("precompensated", replanned.command.is_some().to_string()),
            ("gain", inputs.compensation.gain.to_string()),
            ("seed", inputs.seed.to_string()),
        ]
        .map(|(key, value)| (key.to_owned(), value)),
    );
    let bytes = replanned.log(provenance, RATE_HZ)?;
    write_atomically(path, |file| Ok(file.write_all(&bytes)?))
}
