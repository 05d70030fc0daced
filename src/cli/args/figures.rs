//! Arguments of the verbs that write figures.

use std::path::PathBuf;

use clap::value_parser;

/// Where figures go.
#[derive(Debug, clap::Args)]
pub struct FigureArgs {
    /// Write the plots of the page as SVG files into DIR, which is made where there is none
    #[arg(long, value_name = "DIR")]
    pub figures: Option<PathBuf>,

    /// Write each as PNG too, of DPI dots per inch (300, if not given)
    #[arg(
        long,
        value_name = "DPI",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "300",
        requires = "figures",
        value_parser = value_parser!(u32).range(50..=1200)
    )]
    pub figures_png: Option<u32>,
}
