//! `compare`

use std::{path::PathBuf, slice::from_ref};

use super::{
    CliError, Outcome, Run,
    console::{Console, Form, Target, spare_inputs},
    figures::FigureArgs,
    number::{degrees, millimetres, probability, ratio, reduction_percent},
    read::ReadArgs,
};
use crate::{
    document::pretty,
    render::compare as words,
    workflow::compare::{Gates, Inputs, run},
};

const EXAMPLES: &str = "\
Examples:
  hydrotrace compare before.mcap after.mcap
  hydrotrace compare before.mcap after.mcap --min-peak-reduction-percent 20 --max-p 0.05
  hydrotrace compare a1.mcap b1.mcap --more-before a2.mcap --more-after b2.mcap
  hydrotrace compare old.mcap new.mcap --json -o compare.json";

/// Pairs of transitions listed without `--all`: in text, on a page.
pub(super) const MOST: [usize; 2] = [15, 60];

/// Effect of a change: the same task before and after it
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Args {
    /// Log of the run before the change: an MCAP file or a ROS 2 bag directory
    #[arg(value_name = "BEFORE")]
    before: PathBuf,

    /// Log of the run after it
    #[arg(value_name = "AFTER")]
    after: PathBuf,

    /// Another run before the change; repeat for several, whose mean is compared
    #[arg(long, value_name = "LOG")]
    more_before: Vec<PathBuf>,

    /// Another run after it; repeat for several
    #[arg(long, value_name = "LOG")]
    more_after: Vec<PathBuf>,

    #[command(flatten)]
    format: FormatArgs,

    /// Write to FILE instead of standard output; .html, .json and .md set the form
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,

    #[command(flatten)]
    figures: FigureArgs,

    /// List every pair of transitions instead of the worst
    #[arg(long)]
    all: bool,

    #[command(flatten)]
    read: ReadArgs,

    #[command(flatten)]
    gates: GateArgs,
}

#[derive(Debug, clap::Args)]
#[group(multiple = false)]
struct FormatArgs {
    /// One JSON document (schemas/compare.v2.schema.json in the repository)
    #[arg(long)]
    json: bool,

    /// The comparison as Markdown
    #[arg(long)]
    markdown: bool,

    /// One page for a browser: verdict, plots with zoom, every table; needs no network
    #[arg(long)]
    html: bool,
}

#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Limits (exit code 4 if not kept)")]
struct GateArgs {
    /// Count a limit as kept where the run has nothing to judge it by; without this it counts as not kept
    #[arg(long)]
    allow_empty: bool,

    /// Smallest reduction of the mean peak error at transitions
    #[arg(long, value_name = "PERCENT", value_parser = reduction_percent, allow_negative_numbers = true)]
    min_peak_reduction_percent: Option<f64>,

    /// Largest p value of the reduction of peak errors: the probability of one as large by chance alone
    #[arg(long, value_name = "P", value_parser = probability, allow_negative_numbers = true)]
    max_p: Option<f64>,

    /// Largest growth of the peak error at one transition
    #[arg(long, value_name = "DEG", value_parser = degrees, allow_negative_numbers = true)]
    max_transition_growth_deg: Option<f64>,

    /// Largest growth of the peak error at one transition, of joints that slide
    #[arg(long, value_name = "MM", value_parser = millimetres, allow_negative_numbers = true)]
    max_transition_growth_mm: Option<f64>,

    /// Largest RMS error over the run and all joints, after divided by before
    #[arg(long, value_name = "RATIO", value_parser = ratio, allow_negative_numbers = true)]
    max_rms_ratio: Option<f64>,

    /// Largest peak error over the run and all joints, after divided by before
    #[arg(long, value_name = "RATIO", value_parser = ratio, allow_negative_numbers = true)]
    max_peak_ratio: Option<f64>,

    /// Largest distance of the tool from its plan after; needs the arm in every log
    #[arg(long, value_name = "MM", value_parser = millimetres, allow_negative_numbers = true)]
    max_tool_error_mm: Option<f64>,

    /// Largest distance of the tool from its plan after, where it rests when the run ends
    #[arg(long, value_name = "MM", value_parser = millimetres, allow_negative_numbers = true)]
    max_end_error_mm: Option<f64>,
}

impl Args {
    pub(super) fn request(&self) -> Inputs {
        Inputs {
            before: [from_ref(&self.before), self.more_before.as_slice()].concat(),
            after: [from_ref(&self.after), self.more_after.as_slice()].concat(),
            read: self.read.options(),
            gates: Gates::default()
                .with("peak-reduction", self.gates.min_peak_reduction_percent)
                .with("p", self.gates.max_p)
                .with("transition-growth", self.gates.max_transition_growth_deg)
                .with("transition-growth-sliding", self.gates.max_transition_growth_mm)
                .with("rms-ratio", self.gates.max_rms_ratio)
                .with("peak-ratio", self.gates.max_peak_ratio)
                .with("tool-error", self.gates.max_tool_error_mm)
                .with("end-error", self.gates.max_end_error_mm)
                .with_empty_kept(self.gates.allow_empty),
            ..Inputs::default()
        }
    }
}

impl Run for Args {
    fn run(&self, console: &mut Console<'_>) -> Result<Outcome, CliError> {
        let (request, file) = (self.request(), self.output.as_deref());
        spare_inputs(file, &[request.before.as_slice(), &request.after].concat())?;
        let FormatArgs { json, markdown, html } = self.format;
        let forms = [(json, Form::Json), (markdown, Form::Markdown), (html, Form::Html)];
        let target = Target::new(Form::of(&forms, file), file)?;
        self.figures.check()?;
        let comparison = run(&request)?;
        let most = MOST.map(|most| if self.all { usize::MAX } else { most });
        let result = match target.form {
            Form::Json => pretty(&comparison),
            Form::Html => {
                words::page(&comparison, most[1], [&request.before, &request.after], &self.read.words())
            }
            _ => target.text(&words::document(&comparison, most[0])),
        };
        self.figures.write(console, &target, || words::figures(&comparison))?;
        console.finish(&target, &result, &comparison.remarks, &words::verdicts(&comparison))
    }
}
