//! `--figures`: the plots of a page as files.

use std::{io::Write, path::Path};

#[cfg(feature = "png")]
use super::output::harmless;
use super::{CliError, args::FigureArgs};
#[cfg(feature = "png")]
use crate::render::kit::{Raster, raster};
use crate::{atomic_file::write_atomically, render::kit::Figure};

/// What drawing returns.
type Drawn = Result<Vec<Figure>, Box<dyn std::error::Error + Send + Sync>>;

/// Refuses what this build cannot write, before the work is done.
#[cfg_attr(feature = "png", expect(clippy::unnecessary_wraps, reason = "a build without PNG refuses"))]
pub(super) fn check(args: &FigureArgs) -> Result<(), CliError> {
    #[cfg(not(feature = "png"))]
    if args.figures_png.is_some() {
        return Err(CliError::NoPng);
    }
    let _ = args;
    Ok(())
}

/// Draws, if that is asked for, and only then writes: what cannot be drawn leaves no file.
pub(super) fn figures(
    args: &FigureArgs,
    err: &mut impl Write,
    draw: impl FnOnce() -> Drawn,
) -> Result<(), CliError> {
    let Some(folder) = &args.figures else { return Ok(()) };
    #[cfg(not(feature = "png"))]
    let _ = err;
    let figures = draw().map_err(CliError::Figures)?;
    let mut files: Vec<(String, Vec<u8>)> = Vec::new();
    #[cfg(feature = "png")]
    if let Some(dots_per_inch) = args.figures_png {
        let mut all_lacking = std::collections::BTreeSet::new();
        for Figure { name, svg } in &figures {
            let Raster { png, lacking } = raster(svg, dots_per_inch).map_err(CliError::Figures)?;
            files.push((format!("{name}.png"), png));
            all_lacking.extend(lacking);
        }
        say_lacking(all_lacking, err);
    }
    files.extend(figures.into_iter().map(|figure| (format!("{}.svg", figure.name), figure.svg.into_bytes())));
    std::fs::create_dir_all(folder).map_err(|source| CliError::Folder { path: folder.clone(), source })?;
    files.iter().try_for_each(|(name, bytes)| write(&folder.join(name), bytes))
}

fn write(path: &Path, bytes: &[u8]) -> Result<(), CliError> {
    write_atomically(path, |file| Ok(file.write_all(bytes)?))
}

/// Says what the font within lacks; a figure is no reason to fail.
#[cfg(feature = "png")]
fn say_lacking(lacking: impl IntoIterator<Item = String>, err: &mut impl Write) {
    let lacking: Vec<String> = lacking.into_iter().collect();
    if !lacking.is_empty() {
        let lacking = harmless(&lacking.join(" "));
        // A closed standard error does not make the figures wrong.
        let _ = writeln!(
            err,
            "PNG figures show boxes for {lacking}, which their font lacks; the SVG files have them"
        );
    }
}
