//! `view`: in a build with the feature `viewer`.

use std::path::PathBuf;

use super::{CliError, Outcome, Run, console::Console, number::positive, read::ReadArgs};

const EXAMPLES: &str = "\
Examples:
  hydrotrace view run.mcap
  hydrotrace view before.mcap after.mcap --save compare.rrd
  hydrotrace view run.mcap --connect --speed 0.5
  hydrotrace view bag/ --urdf robot.urdf

The viewer is installed by `pip install rerun-sdk==0.36.3`. Without this command it opens the logs of
plan, simulate and replan too: `rerun run.mcap`.";

/// What a build without Rerun says where it is needed.
#[cfg(not(feature = "viewer"))]
pub(super) const NO_VIEWER: &str = "this build has no viewer; add it from the project's folder (350 more crates, some minutes):\n  \
    cargo install --path . --features viewer\n\
    or from anywhere, with the address of the repository for URL:\n  \
    cargo install --git URL --features viewer\n\
    the viewer itself, and plain logs without this command (those of plan, simulate and replan show the arm):\n  \
    pip install rerun-sdk==0.36.3\n  \
    rerun run.mcap";

/// Where a viewer on this machine listens.
const LOCAL: &str = "rerun+http://127.0.0.1:9876/proxy";

/// Show runs and plans in 3-D: both arms, series, starts from rest
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Args {
    /// Runs or plans to show together: each an MCAP file or a ROS 2 bag directory
    #[arg(required = true, value_name = "LOG")]
    logs: Vec<PathBuf>,

    #[command(flatten)]
    target: TargetArgs,

    /// Send the run as it happened, X times as fast, to a viewer that is open
    #[arg(long, value_name = "X", value_parser = positive, conflicts_with = "save")]
    speed: Option<f64>,

    /// Draw the arm of this URDF instead of the log's; its meshes are looked for beside it and in ROS's paths
    #[arg(long, value_name = "FILE")]
    urdf: Option<PathBuf>,

    #[command(flatten)]
    read: ReadArgs,
}

#[derive(Debug, clap::Args)]
#[group(multiple = false)]
struct TargetArgs {
    /// Write FILE, which `rerun FILE` opens
    #[arg(long, value_name = "FILE.rrd")]
    save: Option<PathBuf>,

    /// Start a viewer; this is the default
    #[arg(long)]
    spawn: bool,

    /// Send to a running viewer [default: one on this machine]
    #[arg(long, value_name = "URL", num_args = 0..=1, default_missing_value = LOCAL)]
    connect: Option<String>,

    /// Start a viewer for browsers on this machine and print its address
    #[arg(long)]
    web: bool,
}

#[cfg(not(feature = "viewer"))]
impl Run for Args {
    fn run(&self, _: &mut Console<'_>) -> Result<Outcome, CliError> {
        Err(CliError::failed(NO_VIEWER))
    }
}

#[cfg(feature = "viewer")]
impl Run for Args {
    fn run(&self, console: &mut Console<'_>) -> Result<Outcome, CliError> {
        use crate::{
            text::shell_argument,
            viewer::{Target, show},
            workflow::view::{Inputs, run},
        };
        super::console::spare_inputs(self.target.save.as_deref(), &self.logs)?;
        let scenes = run(&Inputs {
            logs: self.logs.clone(),
            read: self.read.options(),
            urdf: self.urdf.clone(),
            packages: packages(),
            ..Inputs::default()
        })?;
        // By now meshes are known, which the viewer opens.
        self.target.save.as_deref().map_or(Ok(()), crate::atomic_file::may_write)?;
        let target = match (&self.target.save, &self.target.connect) {
            (Some(path), _) => Target::Save(path.clone()),
            (None, Some(url)) => Target::Connect(url.clone()),
            (None, None) if self.target.web => Target::Web,
            (None, None) => Target::Spawn,
        };
        for scene in &scenes {
            console.say_remarks(&scene.remarks);
        }
        let mut announce =
            |address: &str| console.announce(&format!("{address} shows it; Ctrl-C ends it.\n"));
        show(&scenes, &target, self.speed, &mut announce)?;
        if let Target::Save(path) = &target {
            console.print(&format!(
                "{} written; rerun {} opens it.\n",
                path.display(),
                shell_argument(path)
            ))?;
        }
        let doubtful = scenes.iter().any(|scene| !scene.remarks.is_empty());
        Ok(if doubtful { Outcome::Remarks } else { Outcome::Clean })
    }
}

/// Where ROS keeps packages.
#[cfg(feature = "viewer")]
fn packages() -> Vec<PathBuf> {
    let folders =
        |name| std::env::var_os(name).map(|value| std::env::split_paths(&value).collect::<Vec<_>>());
    let prefixes = folders("AMENT_PREFIX_PATH").unwrap_or_default();
    let sources = folders("ROS_PACKAGE_PATH").unwrap_or_default();
    prefixes.iter().map(|prefix| prefix.join("share")).chain(sources).collect()
}
