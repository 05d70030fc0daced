//! `report`

use std::path::{Path, PathBuf};

use super::{
    CliError, Outcome, Run,
    console::{Console, Form, Target, spare_inputs},
    figures::FigureArgs,
    number::{degrees, milliseconds},
    read::ReadArgs,
};
use crate::{
    render::report as words,
    workflow::{
        fit::LimitsFile,
        report::{Gates, Inputs, Report, run},
    },
};

const EXAMPLES: &str = "\
Examples:
  hydrotrace report run.mcap
  hydrotrace report run.mcap --json -o report.json
  hydrotrace report run.mcap --html -o run.html
  hydrotrace report run.mcap --max-transition-peak-deg 0.5
  hydrotrace report run.mcap --planned /arm/controller_state:output.positions
  hydrotrace report measured.mcap plan.mcap    (two files of one run, one zero of time)";

/// Transitions listed without `--all`: in text, on a page.
const MOST: [usize; 2] = [15, 60];

/// Tracking error of every joint, and of every start from rest
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Args {
    /// Logs of one run: MCAP files (parts of a split bag count as one) or ROS 2 bag directories
    #[arg(required = true, value_name = "LOG")]
    logs: Vec<PathBuf>,

    #[command(flatten)]
    format: FormatArgs,

    /// Write to FILE instead of standard output; .html, .json, .csv and .md set the form
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,

    #[command(flatten)]
    figures: FigureArgs,

    /// Show on the page the machine of FILE, which `fit` wrote
    #[arg(long, value_name = "FILE", requires = "html")]
    limits: Option<PathBuf>,

    /// List every transition instead of the worst
    #[arg(long)]
    all: bool,

    #[command(flatten)]
    read: ReadArgs,

    #[command(flatten)]
    gates: GateArgs,
}

#[derive(Debug, clap::Args)]
#[group(multiple = false)]
#[expect(clippy::struct_excessive_bools, reason = "options of which at most one is given")]
struct FormatArgs {
    /// One JSON document (schemas/report.v2.schema.json in the repository)
    #[arg(long)]
    json: bool,

    /// The transitions as comma-separated values
    #[arg(long)]
    csv: bool,

    /// The report as Markdown
    #[arg(long)]
    markdown: bool,

    /// One page for a browser: verdict, plots with zoom, every table; needs no network
    #[arg(long)]
    html: bool,
}

#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Limits (exit code 4 if not kept)")]
#[expect(clippy::struct_field_names, reason = "the names of options")]
struct GateArgs {
    /// Largest peak error in a transition
    #[arg(long, value_name = "DEG", value_parser = degrees, allow_negative_numbers = true)]
    max_transition_peak_deg: Option<f64>,

    /// Largest RMS error of a joint over the run
    #[arg(long, value_name = "DEG", value_parser = degrees, allow_negative_numbers = true)]
    max_rms_deg: Option<f64>,

    /// Largest peak error of a joint over the run
    #[arg(long, value_name = "DEG", value_parser = degrees, allow_negative_numbers = true)]
    max_peak_deg: Option<f64>,

    /// Largest RMS error of a joint while its plan is at rest
    #[arg(long, value_name = "DEG", value_parser = degrees, allow_negative_numbers = true)]
    max_standstill_rms_deg: Option<f64>,

    /// Largest delay of a start; a start that the machine does not answer exceeds it
    #[arg(long, value_name = "MS", value_parser = milliseconds, allow_negative_numbers = true)]
    max_start_delay_ms: Option<f64>,

    /// Largest velocity lag of a joint
    #[arg(long, value_name = "MS", value_parser = milliseconds, allow_negative_numbers = true)]
    max_lag_ms: Option<f64>,
}

impl Args {
    fn request(&self) -> Inputs {
        let gates = Gates {
            max_transition_peak_rad: self.gates.max_transition_peak_deg,
            max_rms_rad: self.gates.max_rms_deg,
            max_peak_rad: self.gates.max_peak_deg,
            max_standstill_rms_rad: self.gates.max_standstill_rms_deg,
            max_onset_delay_s: self.gates.max_start_delay_ms,
            max_lag_s: self.gates.max_lag_ms,
        };
        Inputs { logs: self.logs.clone(), read: self.read.options(), gates, ..Inputs::default() }
    }
}

impl Run for Args {
    fn run(&self, console: &mut Console<'_>) -> Result<Outcome, CliError> {
        let file = self.output.as_deref();
        spare_inputs(file, &self.logs)?;
        let FormatArgs { json, csv, markdown, html } = self.format;
        let forms = [(json, Form::Json), (csv, Form::Csv), (markdown, Form::Markdown), (html, Form::Html)];
        let target = Target::new(Form::of(&forms, file), file)?;
        self.figures.check()?;
        let report = run(&self.request())?;
        let names = self.logs.iter().filter_map(|p| p.file_name()).map(|n| n.to_string_lossy());
        let name = names.collect::<Vec<_>>().join(", ");
        let most = MOST.map(|most| if self.all { usize::MAX } else { most });
        let result = match target.form {
            Form::Json => words::json(&report),
            Form::Csv => words::csv(&report),
            Form::Html => {
                let limits = self.limits.as_deref().map(|path| limits(path, &report)).transpose()?;
                words::page(&name, &report, limits.as_ref().map(|file| &file.fit), most[1])
            }
            Form::Text | Form::Markdown => target.text(&words::document(&name, &report, most[0])),
        };
        self.figures.write(console, || words::figures(&report))?;
        console.finish(&target, &result, &report.remarks, &words::verdicts(&report))
    }
}

/// The machine for the page; its joints must be those of the run.
fn limits(path: &Path, report: &Report) -> Result<LimitsFile, CliError> {
    let file = LimitsFile::read(path)?;
    file.check_joints(path, report.pairs.iter().map(|pair| pair.name.as_str()))?;
    Ok(file)
}
