//! `bench plan`, with progress on a terminal.

use std::{io::Write, path::Path};

use super::{make, progress};
use crate::{
    cli::{
        CliError, Outcome,
        args::ContestArgs,
        output::{deliver, shown},
    },
    render::{contest_csv, contest_document, contest_json, contest_svg, kit::markdown},
    workflow::contest::{Curve, run as compare},
};

pub(super) fn run(args: &ContestArgs, out: &mut impl Write) -> Result<Outcome, CliError> {
    let inputs = args.inputs()?;
    // Before the work, so that a folder that cannot be made does not cost it.
    if let Some(folder) = &args.curves {
        make(folder)?;
    }
    let bar = progress(inputs.searches(), "searches");
    let study = compare(&inputs, || bar.inc(1));
    bar.finish_and_clear();
    let study = study?;
    if let Some(folder) = &args.curves {
        write_curves(&study.curves, folder, out)?;
    }
    let rendered = if args.format.json {
        contest_json(&inputs, &study)
    } else if args.format.markdown {
        markdown(&contest_document(&inputs, &study))
    } else {
        shown(&contest_document(&inputs, &study), None)
    };
    deliver(&rendered, None, out)?;
    Ok(Outcome::Clean)
}

fn write_curves(curves: &[Curve], folder: &Path, out: &mut impl Write) -> Result<(), CliError> {
    deliver(&contest_csv(curves), Some(&folder.join("curves.csv")), out)?;
    for same in curves.chunk_by(|a, b| a.task == b.task) {
        let Some(first) = same.first() else { continue };
        let svg = contest_svg(same).map_err(CliError::Picture)?;
        deliver(&svg, Some(&folder.join(format!("{}.svg", first.task))), out)?;
    }
    Ok(())
}
