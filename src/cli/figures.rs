//! `--figures`: the plots of a page as files.

use std::path::PathBuf;

use clap::value_parser;

#[cfg(feature = "png")]
use super::terminal::harmless;
use super::{
    CliError,
    console::{Console, Target, make_folder, write_file},
};
#[cfg(feature = "png")]
use crate::render::kit::{Raster, raster};
use crate::{
    atomic_file::may_write,
    render::kit::{Failure, Figure},
};

/// Where figures go.
#[derive(Debug, clap::Args)]
pub(super) struct FigureArgs {
    /// Write the plots of the page to DIR, as SVG files; DIR is made if needed
    #[arg(long, value_name = "DIR")]
    figures: Option<PathBuf>,

    /// Write each as PNG too, with DPI dots per inch (300 if not given)
    #[arg(
        long,
        value_name = "DPI",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "300",
        requires = "figures",
        value_parser = value_parser!(u32).range(50..=1200)
    )]
    figures_png: Option<u32>,
}

impl FigureArgs {
    /// Refuses PNG in a build without it, before the work is done.
    pub(super) fn check(&self) -> Result<(), CliError> {
        if cfg!(feature = "png") || self.figures_png.is_none() {
            return Ok(());
        }
        Err(CliError::failed(
            "this build writes no PNG; add it from the project's folder (40 more crates, about a minute):\n  \
             cargo install --path . --features png\n\
             or leave --figures-png out: --figures alone writes SVG",
        ))
    }

    /// Draws all figures, then writes them: if one cannot be drawn, no file appears.
    pub(super) fn write(
        &self,
        console: &mut Console<'_>,
        target: &Target<'_>,
        draw: impl FnOnce() -> Result<Vec<Figure>, Failure>,
    ) -> Result<(), CliError> {
        let Some(folder) = &self.figures else { return Ok(()) };
        // By now all inputs are known: nothing appears if the result beside the figures may not.
        target.file.map_or(Ok(()), may_write)?;
        let figures = draw().map_err(CliError::step("cannot draw the figures"))?;
        let mut files = self.pixels(console, &figures)?;
        files.extend(figures.into_iter().map(|one| (format!("{}.svg", one.name), one.svg.into_bytes())));
        make_folder(folder)?;
        files.iter().try_for_each(|(name, bytes)| write_file(&folder.join(name), bytes))
    }

    #[cfg(not(feature = "png"))]
    #[expect(clippy::unused_self, clippy::unnecessary_wraps, reason = "as the build with PNG")]
    fn pixels(&self, _: &mut Console<'_>, _: &[Figure]) -> Result<Vec<(String, Vec<u8>)>, CliError> {
        Ok(Vec::new())
    }

    /// The figures as PNG, if asked for; says which characters the font lacks.
    #[cfg(feature = "png")]
    fn pixels(
        &self,
        console: &mut Console<'_>,
        figures: &[Figure],
    ) -> Result<Vec<(String, Vec<u8>)>, CliError> {
        let Some(dots_per_inch) = self.figures_png else { return Ok(Vec::new()) };
        let (mut files, mut lacking) = (Vec::new(), std::collections::BTreeSet::new());
        for Figure { name, svg } in figures {
            let drawn = raster(svg, dots_per_inch).map_err(CliError::step("cannot draw the figures"))?;
            let Raster { png, lacking: missing } = drawn;
            files.push((format!("{name}.png"), png));
            lacking.extend(missing);
        }
        if !lacking.is_empty() {
            let lacking = harmless(&lacking.into_iter().collect::<Vec<_>>().join(" "));
            console.say(format_args!(
                "PNG figures show boxes for {lacking}, which their font lacks; the SVG files have them"
            ));
        }
        Ok(files)
    }
}
