//! `join`

use std::path::PathBuf;

use super::{
    CliError, Outcome, Run,
    console::{Console, spare_for_log},
    number::any_seconds,
    read::ReadArgs,
};
use crate::{
    render::join as words,
    workflow::join::{Inputs, gather, run},
};

const EXAMPLES: &str = "\
Examples:
  hydrotrace join field.mcap --plan next.mcap -o run-2.mcap
  hydrotrace join field.mcap --plan next.mcap --planned /arm/controller_state:reference.positions -o run-2.mcap
  hydrotrace join field.mcap --plan next.mcap --at 12.5 -o run-2.mcap
  hydrotrace join run.mcap run-2.mcap run-3.mcap -o whole.mcap";

/// Put the plan into the log of a run, or its files into one log
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Args {
    /// Logs of one run, with the command that was sent and the measurement: MCAP files, ROS 2 bag directories or tables
    #[arg(required = true, value_name = "LOG")]
    logs: Vec<PathBuf>,

    /// The log that `replan` or `plan` wrote for this run; without it the files of the run become one log as they are
    #[arg(long, value_name = "FILE")]
    plan: Option<PathBuf>,

    /// Write the run, with its plan, to FILE, an MCAP log
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,

    /// Time of the plan's first sample, from the start of the run's log [default: found by the command]
    #[arg(long, value_name = "SECONDS", value_parser = any_seconds, allow_negative_numbers = true, requires = "plan")]
    at: Option<f64>,

    /// Print what was joined as one JSON document
    #[arg(long)]
    json: bool,

    #[command(flatten)]
    read: ReadArgs,
}

impl Run for Args {
    fn run(&self, console: &mut Console<'_>) -> Result<Outcome, CliError> {
        spare_for_log(Some(&self.output), &[&self.logs, self.plan.as_slice()].concat())?;
        let inputs = Inputs {
            logs: self.logs.clone(),
            plan: self.plan.clone().unwrap_or_default(),
            read: self.read.options(),
            at_s: self.at,
            output: self.output.clone(),
        };
        let Some(plan) = &self.plan else {
            if inputs.read.range.cuts() {
                let why = "without --plan all of the files is joined; give --from and --to to the verb that reads the new log";
                return Err(CliError::Usage(why.to_owned()));
            }
            let found = gather(&inputs)?;
            let shown = || words::gathered(&found, &self.output).reading(&self.read.words());
            return console.answer(self.json, &found, shown, &found.remarks, &[]);
        };
        let joined = run(&inputs)?;
        let shown = || {
            words::document(&joined, plan, &self.output)
                .reading(&self.read.words_of_joined(joined.keeps_plan))
        };
        console.answer(self.json, &joined, shown, &joined.remarks, &[])
    }
}
