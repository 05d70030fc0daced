//! `fleet scan`

use std::{num::NonZeroUsize, ops::ControlFlow, path::PathBuf, time::Duration};

use super::{
    CliError, Outcome, Run,
    console::{Console, progress},
    read::ReadArgs,
};
use crate::{
    remark::Remarks,
    render::fleet as words,
    workflow::fleet::{Inputs, MachineFrom, compact, scan},
};

const EXAMPLES: &str = "\
Examples:
  hydrotrace fleet scan /data/logs --into fleet
  hydrotrace fleet scan '/data/*/2026-03-*/run.mcap' --into fleet --machine-from path:2
  hydrotrace fleet scan logs.txt --into fleet --machine-from machines.csv

Only logs that are new or have changed are analysed. A scan that was killed is taken up by the next one; every log has
its rows once. A log that cannot be analysed is a row with its error.";

/// The logs of a dataset.
#[derive(Debug, clap::Args)]
pub(crate) struct SourceArgs {
    /// Folders with logs, patterns ('/data/**/run.mcap'), lists of logs (.txt, a path a line), logs; or the same in a
    /// store: s3://, gs://, az://, https://
    #[arg(required = true, value_name = "SOURCE")]
    sources: Vec<String>,

    /// The folder of the dataset, with an index and pages if it is watched; it is made if it is not there
    #[arg(long, value_name = "DIR")]
    pub(crate) into: PathBuf,

    /// Where the machine's name stands: `log` (metadata entry "machine"), `path:KEY` (a folder KEY=NAME),
    /// `path:N` (N folders above the log), `topic` (first part of the measured topic), a CSV file with the columns
    /// path and machine
    #[arg(long, value_name = "WHERE", default_value = "log")]
    machine_from: String,
}

impl SourceArgs {
    /// These, read with the caller's options.
    pub(crate) fn inputs(&self, read: &ReadArgs) -> Result<Inputs, CliError> {
        let (sources, into, read) = (self.sources.clone(), self.into.clone(), read.options());
        let machine = MachineFrom::parse(&self.machine_from)?;
        Ok(Inputs { sources, into, machine, read, ..Inputs::default() })
    }
}

/// Analyse the logs that the dataset does not hold yet
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Args {
    #[command(flatten)]
    source: SourceArgs,

    /// Logs that are analysed at once [default: one a core; four a core in stores]
    #[arg(long, value_name = "N")]
    workers: Option<NonZeroUsize>,

    /// Fit each run too, for the table of limits; it takes about a second a minute recorded, forty times as long
    #[arg(long)]
    fit: bool,

    /// Print what was done as one JSON document
    #[arg(long)]
    json: bool,

    #[command(flatten)]
    read: ReadArgs,
}

impl Run for Args {
    fn run(&self, console: &mut Console<'_>) -> Result<Outcome, CliError> {
        let workers = self.workers.map_or(0, NonZeroUsize::get);
        let inputs = Inputs { workers, fit: self.fit, ..self.source.inputs(&self.read)? };
        let bar = progress(Some(0), "{spinner} {elapsed}  {msg}, {eta} left");
        bar.enable_steady_tick(Duration::from_millis(200));
        let done = scan(&inputs, &|now| {
            bar.set_length(now.of as u64);
            bar.set_position(now.done as u64);
            bar.set_message(words::progress(&now));
            ControlFlow::Continue(())
        });
        bar.finish_and_clear();
        let done = done?;
        console.answer(self.json, &done, || words::scanned(&done), &done.remarks, &[])
    }
}

/// Join the small files that many scans leave; every row stays
#[derive(Debug, clap::Args)]
pub(super) struct CompactArgs {
    /// The folder of the dataset, as `fleet scan` wrote it
    #[arg(value_name = "DIR")]
    dataset: PathBuf,

    /// Print what was done as one JSON document
    #[arg(long)]
    json: bool,
}

impl Run for CompactArgs {
    fn run(&self, console: &mut Console<'_>) -> Result<Outcome, CliError> {
        let done = compact(&self.dataset)?;
        console.answer(self.json, &done, || words::compacted(&done), &Remarks::default(), &[])
    }
}
