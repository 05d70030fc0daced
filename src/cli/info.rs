//! `info`

use std::path::PathBuf;

use super::{
    CliError, Outcome, Run,
    console::{Console, Target},
    read::ReadArgs,
};
use crate::{
    document::pretty,
    render::info as words,
    workflow::info::{InfoDocument, Inputs, run},
};

/// Topics of a log, those that a report would use, and damage
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// Logs of one run: MCAP files, ROS bags or tables (CSV, Parquet)
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
        let target = Target::stdout(self.json);
        let result = if self.json {
            pretty(&InfoDocument::of(&survey))
        } else {
            target.text(&words::document(&survey))
        };
        console.finish(&target, &result, &survey.remarks, &[])
    }
}
