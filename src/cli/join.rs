//! `join`

use std::{path::PathBuf, slice::from_ref};

use super::{
    CliError, Outcome, Run,
    console::{Console, spare_for_log},
    number::seconds,
    read::ReadArgs,
};
use crate::{
    render::join as words,
    workflow::join::{Inputs, run},
};

const EXAMPLES: &str = "\
Examples:
  hydrotrace join field.mcap --plan next.mcap -o run-2.mcap
  hydrotrace join field.mcap --plan next.mcap --planned /arm/controller_state:reference.positions -o run-2.mcap
  hydrotrace join field.mcap --plan next.mcap --at 12.5 -o run-2.mcap";

/// Put the plan into the log of a run that holds only what was sent
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Args {
    /// Logs of one run, with the command that was sent and the measurement: MCAP files or ROS 2 bag directories
    #[arg(required = true, value_name = "LOG")]
    logs: Vec<PathBuf>,

    /// The log that `replan` or `plan` wrote for this run
    #[arg(long, value_name = "FILE")]
    plan: PathBuf,

    /// Write the run with its plan to FILE, an MCAP log
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,

    /// Time of the plan's first sample, from the start of the run's log [default: found by the command]
    #[arg(long, value_name = "SECONDS", value_parser = seconds, allow_negative_numbers = true)]
    at: Option<f64>,

    /// Print what was joined as one JSON document
    #[arg(long)]
    json: bool,

    #[command(flatten)]
    read: ReadArgs,
}

impl Args {
    fn request(&self) -> Inputs {
        Inputs {
            logs: self.logs.clone(),
            plan: self.plan.clone(),
            read: self.read.options(),
            at_s: self.at,
            output: self.output.clone(),
        }
    }
}

impl Run for Args {
    fn run(&self, console: &mut Console<'_>) -> Result<Outcome, CliError> {
        spare_for_log(Some(&self.output), &[&self.logs, from_ref(&self.plan)].concat())?;
        let joined = run(&self.request())?;
        console.answer(
            self.json,
            &joined,
            || words::document(&joined, &self.plan, &self.output),
            &joined.remarks,
            &[],
        )
    }
}
