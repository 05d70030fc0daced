//! `report`

use std::path::PathBuf;

use super::{
    CliError, Outcome, Run,
    console::{Console, Form, Target, spare_inputs},
    figures::FigureArgs,
    gates::GateArgs,
    read::ReadArgs,
};
use crate::{
    document::pretty,
    render::report as words,
    workflow::{
        fit::LimitsFile,
        report::{DelayModel, Document, Inputs, run},
    },
};

const EXAMPLES: &str = "\
Examples:
  hydrotrace report run.mcap
  hydrotrace report run.mcap --json -o report.json
  hydrotrace report run.mcap --html -o run.html
  hydrotrace report run.mcap --why
  hydrotrace report run.mcap --max-transition-peak-deg 0.5
  hydrotrace report run.mcap --urdf robot.urdf --max-tool-error-mm 20
  hydrotrace report run.mcap --planned /arm/controller_state:output.positions
  hydrotrace report measured.mcap plan.mcap    (two files of one run, one zero of time)";

/// Transitions listed without `--all`: in text, on a page.
const MOST: [usize; 2] = [15, 60];

/// Tracking error of every joint, and of every start from rest
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Args {
    /// Logs of one run: MCAP files (parts of a split bag count as one), ROS 2 bags or tables (CSV, Parquet)
    #[arg(required = true, value_name = "LOG")]
    logs: Vec<PathBuf>,

    #[command(flatten)]
    format: FormatArgs,

    /// Write to FILE instead of standard output; .html, .json, .csv and .md set the form
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,

    #[command(flatten)]
    figures: FigureArgs,

    /// Say why each start is late: dead band, lag, limits; by a model fitted to this run
    #[arg(long)]
    why: bool,

    /// Say so by the machine in FILE, which `fit` wrote, in place of a model fitted to this run; a page shows that machine too
    #[arg(long, value_name = "FILE")]
    limits: Option<PathBuf>,

    /// List every transition instead of the worst
    #[arg(long)]
    all: bool,

    /// The robot's URDF, in place of what the log holds of it: says what the errors are at the tool
    #[arg(long, value_name = "FILE")]
    urdf: Option<PathBuf>,

    /// The link of the URDF that is the tool [default: where the arm ends]
    #[arg(long, value_name = "LINK")]
    tool: Option<String>,

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

impl Args {
    fn request(&self, limits: Option<&LimitsFile>, with_signals: bool) -> Inputs {
        let delay_model = match limits {
            Some(file) => DelayModel::Known(Box::new(file.fit.clone())),
            None if self.why => DelayModel::OfThisRun,
            None if with_signals => DelayModel::OfThisRunIfShort,
            None => DelayModel::None,
        };
        Inputs {
            delay_model,
            with_signals,
            logs: self.logs.clone(),
            read: self.read.options(),
            urdf: self.urdf.clone(),
            tool: self.tool.clone(),
            gates: self.gates.gates.clone(),
            ..Inputs::default()
        }
    }
}

impl Run for Args {
    fn run(&self, console: &mut Console<'_>) -> Result<Outcome, CliError> {
        let file = self.output.as_deref();
        let inputs: Vec<PathBuf> = self.logs.iter().chain(&self.urdf).cloned().collect();
        spare_inputs(file, &inputs)?;
        let FormatArgs { json, csv, markdown, html } = self.format;
        let forms = [(json, Form::Json), (csv, Form::Csv), (markdown, Form::Markdown), (html, Form::Html)];
        let target = Target::new(Form::of(&forms, file), file)?;
        self.figures.check()?;
        let limits = self.limits.as_deref().map(|path| Ok::<_, CliError>((path, LimitsFile::read(path)?)));
        let limits = limits.transpose()?;
        let limits = limits.as_ref().map(|(path, file)| (*path, file));
        let report = run(&self.request(limits.map(|(_, file)| file), target.form == Form::Html))?;
        if let Some((path, file)) = limits {
            // Its joints must be those of the run.
            file.check_joints(path, report.pairs.iter().map(|pair| (pair.name.as_str(), pair.kind)))?;
        }
        let name = words::name(&report);
        let most = MOST.map(|most| if self.all { usize::MAX } else { most });
        let result = match target.form {
            Form::Json => pretty(&Document::of(&report)),
            Form::Csv => words::csv(&report),
            Form::Html => {
                words::page(&name, &report, limits.map(|(_, file)| &file.fit), most[1], &self.read.words())
            }
            Form::Text | Form::Markdown => target.text(&words::document(&name, &report, most[0])),
        };
        self.figures.write(console, &target, || words::figures(&report))?;
        console.finish(&target, &result, &report.remarks, &words::verdicts(&report))
    }
}
