//! Arguments of `demo`.

use std::path::PathBuf;

/// Arguments of `demo`.
#[derive(Debug, clap::Args)]
pub struct DemoArgs {
    /// Leave the files in DIR
    #[arg(long, value_name = "DIR", default_value = "hydrotrace-demo")]
    pub dir: PathBuf,

    /// The machine: dead-band-limited, default, lag-limited, or a TOML file
    #[arg(long, value_name = "PLANT", default_value = "default")]
    pub plant: String,

    /// Seed of noise, jitter and losses; of the second run, one more
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
}
