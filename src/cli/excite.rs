//! `excite`: writes an identification run.

use std::io::Write;

use super::{
    CliError, Outcome,
    args::ExciteArgs,
    output::{deliver, shown, spare_inputs, spare_stdout},
};
use crate::{atomic_file::write_atomically, render::excite::document, workflow::excite::run as excite};

/// Samples a second in the log.
const RATE_HZ: f64 = 100.0;

pub(super) fn run(args: &ExciteArgs, out: &mut impl Write) -> Result<Outcome, CliError> {
    let read: Vec<_> = args.task.iter().cloned().collect();
    spare_inputs(Some(&args.output), &read)?;
    spare_stdout(Some(&args.output))?;
    let excited = excite(&args.inputs())?;
    let bytes = excited.log(RATE_HZ)?;
    write_atomically(&args.output, |file| Ok::<(), CliError>(file.write_all(&bytes)?))?;
    deliver(&shown(&document(&excited, &args.output), None), None, out)?;
    Ok(Outcome::Clean)
}
