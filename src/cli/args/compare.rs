//! Arguments of `compare`.

use std::path::{Path, PathBuf};

use super::{FigureArgs, ReadArgs, degrees, ends, not_negative};
use crate::workflow::compare::Gates;

/// Arguments of `compare`.
#[derive(Debug, clap::Args)]
pub struct CompareArgs {
    /// Log of the run before the change: an MCAP file or a ROS 2 bag directory
    #[arg(value_name = "BEFORE")]
    pub before: PathBuf,

    /// Log of the run after it
    #[arg(value_name = "AFTER")]
    pub after: PathBuf,

    /// Another run before the change; repeat for several, of which the mean is compared
    #[arg(long, value_name = "LOG")]
    pub more_before: Vec<PathBuf>,

    /// Another run after it; repeat for several
    #[arg(long, value_name = "LOG")]
    pub more_after: Vec<PathBuf>,

    /// Form of the comparison
    #[command(flatten)]
    pub format: CompareFormat,

    /// Write to FILE instead of standard output; without an option for the form, .html, .json and .md say it
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,

    /// Its plots as files.
    #[command(flatten)]
    pub figures: FigureArgs,

    /// List every pair of transitions, not only the worst
    #[arg(long)]
    pub all: bool,

    /// What to read.
    #[command(flatten)]
    pub read: ReadArgs,

    /// What must hold.
    #[command(flatten)]
    pub gates: CompareGateArgs,
}

/// At most one of these.
#[derive(Debug, clap::Args)]
#[group(multiple = false)]
pub struct CompareFormat {
    /// One JSON document, as schemas/compare.v2.schema.json in the repository describes it
    #[arg(long)]
    pub json: bool,

    /// The comparison as Markdown
    #[arg(long)]
    pub markdown: bool,

    /// One page for a browser: verdict, plots that zoom, every table; needs no network
    #[arg(long)]
    pub html: bool,
}

impl CompareFormat {
    /// The form that was asked for, else that of the file's ending.
    #[must_use]
    pub fn or_of(&self, file: Option<&Path>) -> Self {
        let Self { json, markdown, html } = *self;
        let ends = |with: &str| !(json || markdown || html) && ends(file, with);
        Self { json: json || ends("json"), markdown: markdown || ends("md"), html: html || ends("html") }
    }
}

/// Limits; exit code 4 if one is not kept.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Limits (exit code 4 if not kept)")]
pub struct CompareGateArgs {
    /// Reduction of the mean peak error at transitions, at least
    #[arg(long, value_name = "PERCENT", value_parser = percent, allow_negative_numbers = true)]
    pub min_peak_reduction_percent: Option<f64>,

    /// p value of the reduction of peak errors, at most: how often chance alone, without any effect, would
    /// give one as large
    #[arg(long, value_name = "P", value_parser = probability, allow_negative_numbers = true)]
    pub max_p: Option<f64>,

    /// Growth of the peak error at any one transition
    #[arg(long, value_name = "DEG", value_parser = degrees, allow_negative_numbers = true)]
    pub max_transition_growth_deg: Option<f64>,

    /// Root mean square error over the run and all joints, after over before
    #[arg(long, value_name = "RATIO", value_parser = ratio, allow_negative_numbers = true)]
    pub max_rms_ratio: Option<f64>,

    /// Peak error over the run and all joints, after over before
    #[arg(long, value_name = "RATIO", value_parser = ratio, allow_negative_numbers = true)]
    pub max_peak_ratio: Option<f64>,
}

impl CompareGateArgs {
    /// The same in SI units; the parsers have converted already.
    pub fn gates(&self) -> Gates {
        Gates::default()
            .with("peak-reduction", self.min_peak_reduction_percent)
            .with("p", self.max_p)
            .with("transition-growth", self.max_transition_growth_deg)
            .with("rms-ratio", self.max_rms_ratio)
            .with("peak-ratio", self.max_peak_ratio)
    }
}

/// Percent, as a share; a negative reduction allows some growth.
fn percent(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(percent) if percent.is_finite() && percent <= 100.0 => Ok(percent / 100.0),
        _ => Err(format!("{text:?} is not a percentage of at most 100")),
    }
}

fn probability(text: &str) -> Result<f64, String> {
    not_negative(text, "probability").and_then(|p| {
        if p <= 1.0 { Ok(p) } else { Err(format!("{text:?} is no probability: it is above 1")) }
    })
}

fn ratio(text: &str) -> Result<f64, String> {
    not_negative(text, "ratio")
}
