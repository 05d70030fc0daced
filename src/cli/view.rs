//! `view`: reads runs and hands them to the viewer, if the program was built with it.

use std::io::Write;

#[cfg(feature = "viewer")]
use super::output::{say_remarks, spare_inputs};
use super::{CliError, Outcome, args::ViewArgs};

#[cfg(not(feature = "viewer"))]
pub(super) fn run(
    _args: &ViewArgs,
    _out: &mut impl Write,
    _err: &mut impl Write,
) -> Result<Outcome, CliError> {
    Err(CliError::NoViewer)
}

#[cfg(feature = "viewer")]
pub(super) fn run(args: &ViewArgs, out: &mut impl Write, err: &mut impl Write) -> Result<Outcome, CliError> {
    use crate::{
        viewer::{Target, show},
        workflow::view::{Inputs, run as view},
    };
    spare_inputs(args.target.save.as_deref(), &args.logs)?;
    let scenes = view(&Inputs {
        logs: args.logs.clone(),
        read: args.read.options(),
        urdf: args.urdf.clone(),
        packages: packages(),
        ..Inputs::default()
    })?;
    let target = match (&args.target.save, &args.target.connect) {
        (Some(path), _) => Target::Save(path.clone()),
        (None, Some(url)) => Target::Connect(url.clone()),
        (None, None) if args.target.web => Target::Web,
        (None, None) => Target::Spawn,
    };
    for scene in &scenes {
        say_remarks(&scene.remarks, err);
    }
    let mut announce =
        |address: &str| writeln!(out, "{address} shows it; Ctrl-C ends it.").and_then(|()| out.flush());
    show(&scenes, &target, args.speed, &mut announce)?;
    if let Target::Save(path) = &target {
        writeln!(out, "{} written; rerun {} opens it.", path.display(), path.display())?;
    }
    let doubtful = scenes.iter().any(|scene| !scene.remarks.is_empty());
    Ok(if doubtful { Outcome::Remarks } else { Outcome::Clean })
}

/// Where ROS keeps packages.
#[cfg(feature = "viewer")]
fn packages() -> Vec<std::path::PathBuf> {
    let folders =
        |name| std::env::var_os(name).map(|value| std::env::split_paths(&value).collect::<Vec<_>>());
    let prefixes = folders("AMENT_PREFIX_PATH").unwrap_or_default();
    let sources = folders("ROS_PACKAGE_PATH").unwrap_or_default();
    prefixes.iter().map(|prefix| prefix.join("share")).chain(sources).collect()
}
