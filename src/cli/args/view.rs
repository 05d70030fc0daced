//! Arguments of `view`.

use std::path::PathBuf;

use super::ReadArgs;

pub(super) const EXAMPLES: &str = "\
Examples:
  hydrotrace view run.mcap
  hydrotrace view before.mcap after.mcap --save compare.rrd
  hydrotrace view run.mcap --connect --speed 0.5
  hydrotrace view bag/ --urdf robot.urdf

The viewer itself comes with `pip install rerun-sdk==0.36.3`. It also opens the logs that plan,
simulate and replan write as they are: `rerun run.mcap`.";

/// Arguments of `view`.
#[derive(Debug, clap::Args)]
pub struct ViewArgs {
    /// Runs or plans to show together: each an MCAP file or a ROS 2 bag directory
    #[arg(required = true, value_name = "LOG")]
    pub logs: Vec<PathBuf>,

    /// Where to show it.
    #[command(flatten)]
    pub target: ViewTarget,

    /// Send it as it happened, X times as fast, to a viewer that is watched
    #[arg(long, value_name = "X", value_parser = positive, conflicts_with = "save")]
    pub speed: Option<f64>,

    /// Draw the arm of this URDF, whatever the logs say; its meshes are found around it and in ROS's paths
    #[arg(long, value_name = "FILE")]
    pub urdf: Option<PathBuf>,

    /// What to read.
    #[command(flatten)]
    pub read: ReadArgs,
}

/// At most one of these.
#[derive(Debug, clap::Args)]
#[group(multiple = false)]
pub struct ViewTarget {
    /// Write FILE, to be opened with `rerun FILE`
    #[arg(long, value_name = "FILE.rrd")]
    pub save: Option<PathBuf>,

    /// Start a viewer; this is the default
    #[arg(long)]
    pub spawn: bool,

    /// Send to a viewer that runs, by default on this machine
    #[arg(long, value_name = "URL", num_args = 0..=1, default_missing_value = LOCAL)]
    pub connect: Option<String>,

    /// Start a viewer for browsers on this machine and say where to open it
    #[arg(long)]
    pub web: bool,
}

/// Where a viewer on this machine listens.
const LOCAL: &str = "rerun+http://127.0.0.1:9876/proxy";

fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(speed) if speed.is_finite() && speed > 0.0 => Ok(speed),
        _ => Err("a number above 0 is expected".to_owned()),
    }
}
