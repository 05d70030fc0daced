//! Clap definitions only. Degrees and milliseconds are accepted here and turned into SI here.

mod bench;
mod compare;
mod contest;
mod demo;
mod excite;
mod export;
mod figures;
mod fit;
mod form;
mod import;
mod join;
mod moea;
mod plan;
mod replan;
mod simulate;
mod terminal;
mod view;

use std::path::PathBuf;

use clap::{Parser, Subcommand, ValueEnum};

pub use bench::{Bench, BenchArgs, DetectorArgs};
pub use compare::CompareArgs;
pub use contest::ContestArgs;
pub use demo::DemoArgs;
pub use excite::ExciteArgs;
pub use export::{ExportArgs, ExportFormat};
pub use figures::FigureArgs;
pub use fit::{FitArgs, SentArgs};
pub use form::ReportFormat;
pub use import::ImportArgs;
pub use join::JoinArgs;
pub use moea::{MoeaArgs, MoeaFormat, OperatorSet};
pub use plan::{ChoiceArgs, PlanArgs, SearchArgs};
pub use replan::{ChangeArgs, ReplanArgs};
pub use simulate::SimulateArgs;
pub use terminal::{CompletionsArgs, ManArgs, TerminalArgs};
pub use view::{ViewArgs, ViewTarget};

use form::ends;

use crate::{
    log::{ReadOptions, Selector, TimeBase},
    units::radians_from_degrees,
    workflow::report::Gates,
};

/// Where a jointed arm leaves its plan: tracking error at every start from rest, from its logs.
///
/// Reads ROS 2 bags and other MCAP logs with planned and measured joint angles; finds both by
/// itself. Times are seconds from the start of the log.
#[derive(Debug, Parser)]
#[command(
    version,
    max_term_width = 100,
    after_help = "Exit codes: 0 finished, 1 failed, 2 bad usage, 3 finished with remarks on the data, \
                  4 finished but a limit (--max-..., --min-...) was not kept."
)]
pub struct Args {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,

    /// What is said besides results.
    #[command(flatten)]
    pub terminal: TerminalArgs,
}

/// One verb for each question.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// The whole loop on a simulated machine, from plan to comparison
    Demo(DemoArgs),
    /// Tracking error of every joint, and of every start from rest
    #[command(
        after_help = "Examples:\n  hydrotrace report run.mcap\n  hydrotrace report run.mcap --json -o report.json\n  \
                            hydrotrace report run.mcap --html -o run.html\n  \
                            hydrotrace report run.mcap --max-transition-peak-deg 0.5\n  \
                            hydrotrace report run.mcap --planned /arm/controller_state:output.positions\n  \
                            hydrotrace report measured.mcap plan.mcap    (two files of one run, one zero of time)"
    )]
    Report(ReportArgs),
    /// What a change did: the same task before and after it
    #[command(after_help = "Examples:\n  hydrotrace compare before.mcap after.mcap\n  \
                            hydrotrace compare before.mcap after.mcap --min-peak-reduction-percent 20 --max-p 0.05\n  \
                            hydrotrace compare a1.mcap b1.mcap --more-before a2.mcap --more-after b2.mcap\n  \
                            hydrotrace compare old.mcap new.mcap --json -o compare.json")]
    Compare(CompareArgs),
    /// The best timings of a task's key points, the one to run as a log
    #[command(
        after_help = "Examples:\n  hydrotrace plan task.toml -o plan.mcap\n  hydrotrace plan task.toml --choose fastest\n  \
                            hydrotrace plan task.toml --times 0,2.01,3.77,5.79,6.53,8.85,10.48\n  \
                            hydrotrace plan task.toml --json --evaluations 100000 > plan.json"
    )]
    Plan(PlanArgs),
    /// Run a plan on a simulated hydraulic arm
    #[command(after_help = "Examples:\n  hydrotrace simulate plan.mcap -o run.mcap\n  \
                            hydrotrace simulate plan.mcap -o run.mcap --plant lag-limited --seed 7")]
    Simulate(SimulateArgs),
    /// Lag, dead band and limits of the machine, from logs of runs
    #[command(after_help = "Examples:\n  hydrotrace fit run.mcap -o limits.toml\n  \
                            hydrotrace fit run-1.mcap run-2.mcap identification.mcap -o limits.toml\n  \
                            hydrotrace fit run.mcap --command /arm/command:position --json")]
    Fit(FitArgs),
    /// Write a run of slow and fast strokes, for `fit` to tell limits
    #[command(after_help = "Examples:\n  hydrotrace excite -o id.mcap --task task.toml\n  \
                            hydrotrace excite -o id.mcap --joint boom=40:20:60 --joint arm=90:70:110 --max-speed-deg-s 30")]
    Excite(ExciteArgs),
    /// Plan and command for the next run, from logs of the last ones
    #[command(after_help = "Examples:\n  hydrotrace replan run.mcap -o next.mcap\n  \
                            hydrotrace replan run.mcap -o next.mcap --gain 0.5\n  \
                            hydrotrace replan field.mcap -o next.mcap --keep-plan\n  \
                            hydrotrace replan run-1.mcap run-2.mcap --limits limits.toml --task task.toml -o next.mcap")]
    Replan(ReplanArgs),
    /// Put the plan into the log of a run that holds only what was sent
    #[command(after_help = join::EXAMPLES)]
    Join(JoinArgs),
    /// Turn a CSV file (PLC trace, RTDE, any table) into a log
    #[command(after_help = import::EXAMPLES)]
    Import(ImportArgs),
    /// Turn plan, command and measurement of a log into CSV or Parquet
    #[command(after_help = export::EXAMPLES)]
    Export(ExportArgs),
    /// What is in a log, what a report would use, what is damaged
    Info(InfoArgs),
    /// Save everything that is whole in a damaged log
    Recover(RecoverArgs),
    /// Show runs and plans in 3-D: both arms, series, starts from rest
    #[command(after_help = view::EXAMPLES)]
    View(ViewArgs),
    /// Measure hydrotrace itself
    Bench(BenchArgs),
    /// Print the completions of a shell
    #[command(after_help = terminal::COMPLETIONS)]
    Completions(CompletionsArgs),
    /// Write a manual page for each verb
    #[command(after_help = terminal::MANUAL)]
    Man(ManArgs),
}

/// What to read, where the log alone does not tell.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Reading")]
pub struct ReadArgs {
    /// Topic of the plan, with a field where it has several; repeat for several topics
    #[arg(long, value_name = "TOPIC[:FIELD]", value_parser = selector)]
    pub planned: Vec<Selector>,

    /// Topic of the measurement, with a field where it has several; repeat for several topics
    #[arg(long, value_name = "TOPIC[:FIELD]", value_parser = selector)]
    pub measured: Vec<Selector>,

    /// Joints to use, in this order; also the names for topics that carry none
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    pub joints: Vec<String>,

    /// Clock to use; by default the header's stamps where they move
    #[arg(long, value_enum, value_name = "CLOCK")]
    pub time: Option<Time>,

    /// The plan is in degrees
    #[arg(long)]
    pub planned_degrees: bool,

    /// The measurement is in degrees
    #[arg(long)]
    pub measured_degrees: bool,

    /// Joints without end stops, whose angle wraps by full turns
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    pub continuous: Vec<String>,
}

/// Clocks of a message.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Time {
    /// When the sample was taken
    Header,
    /// When the message was published
    Publish,
    /// When the recorder received it
    Log,
}

impl ReadArgs {
    /// The same for the library.
    pub fn options(&self) -> ReadOptions {
        ReadOptions {
            planned: self.planned.clone(),
            measured: self.measured.clone(),
            joints: self.joints.clone(),
            time_base: self.time.map(|time| match time {
                Time::Header => TimeBase::Header,
                Time::Publish => TimeBase::Publish,
                Time::Log => TimeBase::Log,
            }),
            planned_in_degrees: self.planned_degrees,
            measured_in_degrees: self.measured_degrees,
            planned_is_no_angle: false,
            continuous: self.continuous.clone(),
        }
    }
}

/// Arguments of `report`.
#[derive(Debug, clap::Args)]
pub struct ReportArgs {
    /// Logs of one run: MCAP files (parts of a split bag count as one) or ROS 2 bag directories
    #[arg(required = true, value_name = "LOG")]
    pub logs: Vec<PathBuf>,

    /// Form of the report
    #[command(flatten)]
    pub format: ReportFormat,

    /// Write to FILE instead of standard output; without an option for the form, .html, .json, .csv and .md say it
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,

    /// Its plots as files.
    #[command(flatten)]
    pub figures: FigureArgs,

    /// Show the machine of FILE, which `fit` wrote, on the page
    #[arg(long, value_name = "FILE", requires = "html")]
    pub limits: Option<PathBuf>,

    /// List every transition, not only the worst
    #[arg(long)]
    pub all: bool,

    /// What to read.
    #[command(flatten)]
    pub read: ReadArgs,

    /// What must hold.
    #[command(flatten)]
    pub gates: GateArgs,
}

/// Limits; exit code 4 if one is not kept.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Limits (exit code 4 if not kept)")]
pub struct GateArgs {
    /// Peak error in any transition
    #[arg(long, value_name = "DEG", value_parser = degrees, allow_negative_numbers = true)]
    pub max_transition_peak_deg: Option<f64>,

    /// Root mean square error of any joint over the run
    #[arg(long, value_name = "DEG", value_parser = degrees, allow_negative_numbers = true)]
    pub max_rms_deg: Option<f64>,

    /// Peak error of any joint over the run
    #[arg(long, value_name = "DEG", value_parser = degrees, allow_negative_numbers = true)]
    pub max_peak_deg: Option<f64>,

    /// Root mean square error of any joint while its plan rests
    #[arg(long, value_name = "DEG", value_parser = degrees, allow_negative_numbers = true)]
    pub max_standstill_rms_deg: Option<f64>,

    /// Delay of any start; a start without an answer breaks it
    #[arg(long, value_name = "MS", value_parser = milliseconds, allow_negative_numbers = true)]
    pub max_start_delay_ms: Option<f64>,

    /// Velocity lag of any joint
    #[arg(long, value_name = "MS", value_parser = milliseconds, allow_negative_numbers = true)]
    pub max_lag_ms: Option<f64>,
}

impl GateArgs {
    /// The same in SI units; the parsers have converted already.
    pub fn gates(&self) -> Gates {
        Gates {
            max_transition_peak_rad: self.max_transition_peak_deg,
            max_rms_rad: self.max_rms_deg,
            max_peak_rad: self.max_peak_deg,
            max_standstill_rms_rad: self.max_standstill_rms_deg,
            max_onset_delay_s: self.max_start_delay_ms,
            max_lag_s: self.max_lag_ms,
        }
    }
}

/// Arguments of `info`.
#[derive(Debug, clap::Args)]
pub struct InfoArgs {
    /// Logs of one run: MCAP files or ROS 2 bag directories
    #[arg(required = true, value_name = "LOG")]
    pub logs: Vec<PathBuf>,

    /// One JSON document
    #[arg(long)]
    pub json: bool,

    /// What to read.
    #[command(flatten)]
    pub read: ReadArgs,
}

/// Arguments of `recover`.
#[derive(Debug, clap::Args)]
pub struct RecoverArgs {
    /// The damaged log
    pub log: PathBuf,

    /// The sound log to write
    #[arg(short, long, value_name = "OUT")]
    pub output: PathBuf,

    /// Say what was saved as one JSON document
    #[arg(long)]
    pub json: bool,
}

#[expect(clippy::unnecessary_wraps, reason = "the form of a clap parser")]
fn selector(text: &str) -> Result<Selector, String> {
    Ok(Selector::parse(text))
}

fn not_negative(text: &str, what: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() && value >= 0.0 => Ok(value),
        _ => Err(format!("{text:?} is not a non-negative {what}")),
    }
}

/// Degrees, as radians.
fn degrees(text: &str) -> Result<f64, String> {
    not_negative(text, "angle in degrees").map(radians_from_degrees)
}

/// Milliseconds, as seconds.
fn milliseconds(text: &str) -> Result<f64, String> {
    not_negative(text, "time in milliseconds").map(|ms| ms / 1e3)
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn definitions_are_consistent() {
        Args::command().debug_assert();
    }

    #[test]
    fn degrees_and_milliseconds_become_si_at_the_edge() {
        let args = Args::try_parse_from([
            "hydrotrace",
            "report",
            "a.mcap",
            "--max-rms-deg",
            "180",
            "--max-start-delay-ms",
            "250",
        ]);
        let Command::Report(report) = args.unwrap().command else { panic!("not a report") };
        assert_eq!(report.gates.gates().max_rms_rad, Some(std::f64::consts::PI));
        assert_eq!(report.gates.gates().max_onset_delay_s, Some(0.25));
    }

    #[test]
    fn a_topic_is_split_from_its_field_at_the_colon() {
        let selector = selector("/arm/state:output.positions").unwrap();
        assert_eq!(
            (selector.topic.as_str(), selector.field.as_deref()),
            ("/arm/state", Some("output.positions"))
        );
    }
}
