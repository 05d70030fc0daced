//! `fleet worst`, `fleet drift`, `fleet effect` and `fleet gate`

use std::path::PathBuf;

use chrono::{DateTime, NaiveDate};
use clap::{ValueEnum, builder::PossibleValue};
use serde::Serialize;

use super::{
    CliError, Outcome, Run,
    console::{Console, Form, Target, spare_inputs},
    number::{degrees, millimetres, milliseconds},
};
use crate::{
    document::pretty,
    remark::Remarks,
    render::{fleet as words, kit},
    workflow::fleet::{By, Filter, Gate, drift, effect, effect_of_last_note, gate, worst},
};

/// Rows that are shown without `--all`.
const MOST: usize = 15;

/// The dataset, and what of it is asked for.
#[derive(Debug, clap::Args)]
struct AskArgs {
    /// The folder of the dataset, as `fleet scan` wrote it
    #[arg(value_name = "DIR")]
    dataset: PathBuf,

    /// One joint only
    #[arg(long, value_name = "JOINT")]
    joint: Option<String>,

    /// Runs from this day on only: 2026-03-01 or 2026-03-01T12:00:00Z
    #[arg(long, value_name = "DATE", value_parser = date)]
    since: Option<i64>,
}

/// The same of one machine.
#[derive(Debug, clap::Args)]
struct OneArgs {
    #[command(flatten)]
    ask: AskArgs,

    /// One machine only
    #[arg(long, value_name = "MACHINE")]
    machine: Option<String>,
}

/// The form of an answer.
#[derive(Debug, clap::Args)]
#[expect(clippy::struct_excessive_bools, reason = "options of which at most one form is given")]
struct FormArgs {
    /// One JSON document
    #[arg(long, conflicts_with_all = ["csv", "markdown", "html"])]
    json: bool,

    /// Comma-separated values, in SI units
    #[arg(long, conflicts_with_all = ["markdown", "html"])]
    csv: bool,

    /// Markdown
    #[arg(long, conflicts_with = "html")]
    markdown: bool,

    /// One page for a browser, which fetches nothing
    #[arg(long)]
    html: bool,

    /// Write to FILE instead of standard output; .html, .json, .csv and .md set the form
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,

    /// List every row instead of the first
    #[arg(long)]
    all: bool,
}

impl ValueEnum for By {
    fn value_variants<'a>() -> &'a [Self] {
        &Self::ALL
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        let (name, help) = match self {
            Self::Peak => ("peak", "Largest tracking error after a start"),
            Self::Delay => ("delay", "Dead time of a start"),
            Self::Lag => ("lag", "Lag over a run"),
        };
        Some(PossibleValue::new(name).help(help))
    }
}

/// A day or an instant, as microseconds since 1970; UTC unless it says otherwise.
pub(super) fn date(text: &str) -> Result<i64, String> {
    let day = NaiveDate::parse_from_str(text, "%Y-%m-%d").ok().and_then(|day| day.and_hms_opt(0, 0, 0));
    let instant = || DateTime::parse_from_rfc3339(text).ok().map(|at| at.timestamp_micros());
    day.map(|day| day.and_utc().timestamp_micros()).or_else(instant).ok_or_else(|| {
        format!("{text:?} is neither a day as 2026-03-01 nor an instant as 2026-03-01T12:00:00Z")
    })
}

impl AskArgs {
    fn filter(&self) -> Filter {
        Filter { machine: None, joint: self.joint.clone(), since_us: self.since }
    }
}

impl OneArgs {
    fn filter(&self) -> Filter {
        Filter { machine: self.machine.clone(), ..self.ask.filter() }
    }
}

impl FormArgs {
    fn target(&self) -> Result<Target<'_>, CliError> {
        let file = self.output.as_deref();
        spare_inputs(file, &[])?;
        let Self { json, csv, markdown, html, .. } = *self;
        let forms = [(json, Form::Json), (markdown, Form::Markdown), (csv, Form::Csv), (html, Form::Html)];
        Target::new(Form::of(&forms, file), file)
    }

    fn write<T: Serialize>(
        &self,
        console: &mut Console<'_>,
        (found, remarks): (&T, &Remarks),
        [csv, html]: [fn(&T) -> String; 2],
        text: fn(&T, usize) -> kit::Document,
    ) -> Result<Outcome, CliError> {
        let target = self.target()?;
        let result = match target.form {
            Form::Json => pretty(found),
            Form::Csv => csv(found),
            Form::Html => html(found),
            _ => target.text(&text(found, if self.all { usize::MAX } else { MOST })),
        };
        console.finish(&target, &result, remarks, &[])
    }
}

/// The joints with the largest errors, dead times or lags
#[derive(Debug, clap::Args)]
pub(super) struct WorstArgs {
    #[command(flatten)]
    of: OneArgs,

    /// What joints are ranked by
    #[arg(long, value_enum, default_value_t = By::Peak)]
    by: By,

    #[command(flatten)]
    form: FormArgs,
}

impl Run for WorstArgs {
    fn run(&self, console: &mut Console<'_>) -> Result<Outcome, CliError> {
        let found = worst(&self.of.ask.dataset, &self.of.filter(), self.by)?;
        let forms = [words::worst_csv, words::worst_page];
        self.form.write(console, (&found, &found.remarks), forms, words::worst)
    }
}

/// The joints that change over the days: how fast, how sure, since when
#[derive(Debug, clap::Args)]
pub(super) struct DriftArgs {
    #[command(flatten)]
    of: OneArgs,

    /// One metric only; fewer trends are corrected for [default: peak error and dead time]
    #[arg(long, value_enum)]
    by: Option<By>,

    #[command(flatten)]
    form: FormArgs,
}

impl Run for DriftArgs {
    fn run(&self, console: &mut Console<'_>) -> Result<Outcome, CliError> {
        let by = self.by.map_or(vec![By::Peak, By::Delay], |by| vec![by]);
        let found = drift(&self.of.ask.dataset, &self.of.filter(), &by)?;
        let forms = [words::drift_csv, words::drift_page];
        self.form.write(console, (&found, &found.remarks), forms, words::drift)
    }
}

/// What a repair did: before and after at the same starts, against the rest of the fleet
#[derive(Debug, clap::Args)]
pub(super) struct EffectArgs {
    #[command(flatten)]
    ask: AskArgs,

    /// The machine [default without --at: the one that was noted last]
    #[arg(long, value_name = "MACHINE")]
    machine: Option<String>,

    /// When it was changed; runs that begin then are after it [default: when the last thing was done that `fleet note`
    /// noted of it]
    #[arg(long, value_name = "DATE", value_parser = date, requires = "machine")]
    at: Option<i64>,

    /// One metric only; fewer effects are corrected for [default: peak error and dead time]
    #[arg(long, value_enum)]
    by: Option<By>,

    #[command(flatten)]
    form: FormArgs,
}

impl Run for EffectArgs {
    fn run(&self, console: &mut Console<'_>) -> Result<Outcome, CliError> {
        let by = self.by.map_or(vec![By::Peak, By::Delay], |by| vec![by]);
        let dataset = &self.ask.dataset;
        let filter = self.ask.filter();
        let found = match (&self.machine, self.at) {
            (Some(machine), Some(at_us)) => effect(dataset, machine, at_us, &filter, &by),
            (machine, _) => effect_of_last_note(dataset, machine.as_deref(), &filter, &by),
        }?;
        let forms = [words::effect_csv, words::effect_page];
        self.form.write(console, (&found, &found.remarks), forms, words::effect)
    }
}

/// Limits on what joints may drift by; exit code 4 if one is not kept
#[derive(Debug, clap::Args)]
pub(super) struct GateArgs {
    #[command(flatten)]
    of: OneArgs,

    /// Growth of the dead time a day, at most
    #[arg(long, value_name = "MS", value_parser = milliseconds)]
    max_drift_delay_ms: Option<f64>,

    /// Growth of the lag a day, at most
    #[arg(long, value_name = "MS", value_parser = milliseconds)]
    max_drift_lag_ms: Option<f64>,

    /// Growth of the peak error a day, at most
    #[arg(long, value_name = "DEG", value_parser = degrees)]
    max_drift_peak_deg: Option<f64>,

    /// Growth of the peak error a day, at most, of joints that slide
    #[arg(long, value_name = "MM", value_parser = millimetres)]
    max_drift_peak_mm: Option<f64>,

    /// Count a limit as kept where the run has nothing to judge it by; without this it counts as not kept
    #[arg(long)]
    allow_empty: bool,

    /// One JSON document
    #[arg(long, conflicts_with = "markdown")]
    json: bool,

    /// Markdown
    #[arg(long)]
    markdown: bool,
}

impl Run for GateArgs {
    fn run(&self, console: &mut Console<'_>) -> Result<Outcome, CliError> {
        let limits = [
            (By::Delay, "s", self.max_drift_delay_ms),
            (By::Lag, "s", self.max_drift_lag_ms),
            (By::Peak, "rad", self.max_drift_peak_deg),
            (By::Peak, "m", self.max_drift_peak_mm),
        ];
        let gates = limits.into_iter().filter_map(|(metric, unit, limit)| {
            Some(Gate { metric, unit: unit.to_owned(), most_per_day: limit? })
        });
        let gates: Vec<Gate> = gates.collect();
        if gates.is_empty() {
            return Err(CliError::Usage("no limit is given; --max-drift-delay-ms 5 is one".to_owned()));
        }
        let filter = self.of.filter();
        let found = gate(&self.of.ask.dataset, &filter, &gates, self.allow_empty)?;
        let form = Form::of(&[(self.json, Form::Json), (self.markdown, Form::Markdown)], None);
        let target = Target::new(form, None)?;
        let result = if self.json { pretty(&found) } else { target.text(&words::gate(&found)) };
        console.finish(&target, &result, &found.remarks, &words::gate_verdicts(&found))
    }
}
