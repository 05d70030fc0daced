//! `recover`

use std::path::PathBuf;

use super::{
    CliError, Outcome, Run,
    console::{Console, spare_for_log},
};
use crate::{log::recover, render::recover as words, workflow::recover::RecoverDocument};

/// Save every intact message of a damaged log
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// The damaged log, the parts of one run, or a bag directory: one log is made of them
    #[arg(required = true, value_name = "LOG")]
    logs: Vec<PathBuf>,

    /// Write the intact messages to OUT, an MCAP log
    #[arg(short, long, value_name = "OUT")]
    output: PathBuf,

    /// Print what was saved as one JSON document
    #[arg(long)]
    json: bool,
}

impl Run for Args {
    fn run(&self, console: &mut Console<'_>) -> Result<Outcome, CliError> {
        spare_for_log(Some(&self.output), &self.logs)?;
        let document = RecoverDocument::of(recover(&self.logs, &self.output)?);
        let recovered = &document.recovered;
        let shown = || words::document(&self.output.to_string_lossy(), recovered);
        console.answer(self.json, &document, shown, &recovered.remarks, &[])
    }
}
