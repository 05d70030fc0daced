//! Arguments of `replan`.

use std::path::PathBuf;

use super::{SentArgs, degrees};
use crate::{fit::Compensation, workflow::replan::Inputs};

/// Arguments of `replan`.
#[derive(Debug, clap::Args)]
pub struct ReplanArgs {
    /// Logs of runs of one machine, each a file or a bag directory; the plan is that of the last
    #[arg(required = true, value_name = "RUN")]
    pub logs: Vec<PathBuf>,

    /// Write plan and command to FILE, an MCAP log with both as channels of their own
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,

    /// Take the machine from a file that `fit` wrote, in place of fitting the runs
    #[arg(long, value_name = "FILE")]
    pub limits: Option<PathBuf>,

    /// The task, in place of the one that the last log holds
    #[arg(long, value_name = "FILE")]
    pub task: Option<PathBuf>,

    /// One JSON document, as schemas/replan.v2.schema.json in the repository describes it
    #[arg(long)]
    pub json: bool,

    /// What may change.
    #[command(flatten)]
    pub change: ChangeArgs,

    /// What to read.
    #[command(flatten)]
    pub sent: SentArgs,
}

/// What may change, and how far.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "What may change")]
pub struct ChangeArgs {
    /// Only change the command; needs no task, works on any log with planned and measured joints
    #[arg(long, conflicts_with = "no_precompensation")]
    pub keep_plan: bool,

    /// Only change the plan, where commands cannot be sent beside it
    #[arg(long)]
    pub no_precompensation: bool,

    /// Share of the correction that the command makes, 0 to 1; 0.5 for a cautious first run
    #[arg(long, value_name = "SHARE", default_value_t = 1.0, value_parser = share)]
    pub gain: f64,

    /// Farthest that the command may leave the plan [default: 1.5]
    #[arg(long, value_name = "DEG", value_parser = degrees, allow_negative_numbers = true)]
    pub max_correction_deg: Option<f64>,

    /// How much longer the plan may take
    #[arg(long, value_name = "PERCENT", default_value = "0", value_parser = percent)]
    pub max_time_growth_percent: f64,

    /// How much its jerk and its power may grow
    #[arg(long, value_name = "PERCENT", default_value = "10", value_parser = percent)]
    pub max_cost_growth_percent: f64,

    /// Evaluations of the search, 15 % of them with predicted errors
    #[arg(long, value_name = "N", default_value_t = 20_000, value_parser = clap::value_parser!(u64).range(1000..=100_000_000))]
    pub evaluations: u64,

    /// Seed of the search
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
}

impl ReplanArgs {
    /// The same for the workflow.
    pub fn inputs(&self) -> Inputs {
        let change = &self.change;
        let compensation = Compensation { gain: change.gain, ..Compensation::default() };
        let most_rad = change.max_correction_deg.unwrap_or(compensation.most_rad);
        Inputs {
            logs: self.logs.clone(),
            wanted: self.sent.wanted(),
            limits: self.limits.clone(),
            task: self.task.clone(),
            keep_plan: change.keep_plan,
            precompensate: !change.no_precompensation,
            compensation: Compensation { most_rad, ..compensation },
            time_growth: change.max_time_growth_percent,
            cost_growth: change.max_cost_growth_percent,
            evaluations: change.evaluations,
            seed: change.seed,
            ..Inputs::default()
        }
    }
}

fn share(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if (0.0..=1.0).contains(&value) => Ok(value),
        _ => Err(format!("{text:?} is not a number from 0 to 1")),
    }
}

/// Percent, as a share.
fn percent(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if (0.0..=1000.0).contains(&value) => Ok(value / 100.0),
        _ => Err(format!("{text:?} is not a number from 0 to 1000")),
    }
}
