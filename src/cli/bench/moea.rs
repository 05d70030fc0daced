//! `bench moea`, with progress on a terminal.

use std::{io::Write, path::Path};

use super::{make, progress};
use crate::{
    cli::{
        CliError, Outcome,
        args::MoeaArgs,
        output::{deliver, shown},
    },
    render::{curve_svg, curves_csv, front_csv, kit::markdown, moea_document, moea_json},
    workflow::moea::{Curve, Front, run as compare},
};

pub(super) fn run(args: &MoeaArgs, out: &mut impl Write) -> Result<Outcome, CliError> {
    // Before the work, so that a folder that cannot be made does not cost it.
    for folder in args.front.iter().chain(&args.curves) {
        make(folder)?;
    }
    let inputs = args.inputs();
    let bar = progress(inputs.runs(), "runs");
    let study = compare(&inputs, || bar.inc(1))?;
    bar.finish_and_clear();
    if let Some(folder) = &args.front {
        write_fronts(&study.fronts, folder, out)?;
    }
    if let Some(folder) = &args.curves {
        write_curves(&study.curves, folder, out)?;
    }
    let rendered = if args.format.json {
        moea_json(&inputs, &study)
    } else if args.format.markdown {
        markdown(&moea_document(&inputs, &study))
    } else {
        shown(&moea_document(&inputs, &study), None)
    };
    deliver(&rendered, None, out)?;
    Ok(Outcome::Clean)
}

fn write_fronts(fronts: &[Front], folder: &Path, out: &mut impl Write) -> Result<(), CliError> {
    for front in fronts {
        let Front { problem, algorithm, evaluations, seed, .. } = front;
        let name = format!("{}-{algorithm}-{evaluations}-{seed}.csv", problem.to_lowercase());
        deliver(&front_csv(front), Some(&folder.join(name)), out)?;
    }
    Ok(())
}

fn write_curves(curves: &[Curve], folder: &Path, out: &mut impl Write) -> Result<(), CliError> {
    deliver(&curves_csv(curves), Some(&folder.join("curves.csv")), out)?;
    for same in curves.chunk_by(|a, b| a.problem == b.problem) {
        let Some(first) = same.first() else { continue };
        let svg = curve_svg(same).map_err(CliError::Picture)?;
        let name = format!("{}.svg", first.problem.to_lowercase());
        deliver(&svg, Some(&folder.join(name)), out)?;
    }
    Ok(())
}
