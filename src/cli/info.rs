//! `info`

use std::path::PathBuf;

use super::{CliError, Outcome, Run, console::Console, read::ReadArgs};
use crate::{
    render::info as words,
    workflow::info::{InfoDocument, Inputs, run},
};

/// Topics of a log, those that a report would use, and damage
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// Logs of one run: MCAP files, ROS 2 bags or tables (CSV, Parquet)
    #[arg(required = true, value_name = "LOG")]
    logs: Vec<PathBuf>,

    /// One JSON document
    #[arg(long)]
    json: bool,

    /// Read every message of a large log, too, for damage and for what a report would use
    #[arg(long)]
    check: bool,

    #[command(flatten)]
    read: ReadArgs,
}

impl Run for Args {
    fn run(&self, console: &mut Console<'_>) -> Result<Outcome, CliError> {
        let survey = run(&Inputs { logs: self.logs.clone(), read: self.read.options(), check: self.check })?;
        let document = InfoDocument::of(&survey);
        console.answer(self.json, &document, || words::document(&survey), &survey.remarks, &[])
    }
}
