//! Arguments of `join`.

use std::path::PathBuf;

use super::ReadArgs;
use crate::workflow::join::Inputs;

pub(super) const EXAMPLES: &str = "Examples:
  hydrotrace join field.mcap --plan next.mcap -o run-2.mcap
  hydrotrace join field.mcap --plan next.mcap --planned /arm/controller_state:reference.positions -o run-2.mcap
  hydrotrace join field.mcap --plan next.mcap --at 12.5 -o run-2.mcap";

/// Arguments of `join`.
#[derive(Debug, clap::Args)]
pub struct JoinArgs {
    /// Logs of one run: MCAP files or ROS 2 bag directories with what was sent and what was measured
    #[arg(required = true, value_name = "LOG")]
    pub logs: Vec<PathBuf>,

    /// The log that `replan` or `plan` wrote for this run
    #[arg(long, value_name = "FILE")]
    pub plan: PathBuf,

    /// Write the run with its plan to FILE, an MCAP log
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,

    /// When the plan's first sample was sent, from the start of the run's log; by default found by what was sent
    #[arg(long, value_name = "SECONDS", value_parser = seconds, allow_negative_numbers = true)]
    pub at: Option<f64>,

    /// Say what was joined as one JSON document
    #[arg(long)]
    pub json: bool,

    /// What to read of the run; its plan is what was sent.
    #[command(flatten)]
    pub read: ReadArgs,
}

impl JoinArgs {
    /// The same for the workflow.
    pub fn inputs(&self) -> Inputs {
        Inputs {
            logs: self.logs.clone(),
            plan: self.plan.clone(),
            read: self.read.options(),
            at_s: self.at,
            output: self.output.clone(),
        }
    }
}

fn seconds(text: &str) -> Result<f64, String> {
    super::not_negative(text, "time in seconds")
}
