//! Arguments of `simulate`.

use std::path::PathBuf;

/// Arguments of `simulate`.
#[derive(Debug, clap::Args)]
pub struct SimulateArgs {
    /// Log with a plan, and the command if that is not the plan; the task in it names the arm
    #[arg(value_name = "LOG")]
    pub log: PathBuf,

    /// Write the run to FILE, an MCAP log
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,

    /// The machine: dead-band-limited, default, lag-limited, or a TOML file
    #[arg(long, value_name = "PLANT", default_value = "default")]
    pub plant: String,

    /// Seed of noise, jitter and losses
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
}
