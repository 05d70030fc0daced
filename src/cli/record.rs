//! `record`

use std::{
    path::{Path, PathBuf},
    time::{Duration, Instant},
};

use clap::Parser as _;

use super::{
    CliError, Outcome, Run,
    columns::ColumnArgs,
    console::{Console, Target, progress, spare_for_log},
    lines::Lines,
    number::seconds,
    report,
};
use crate::{
    atomic_file::is_keeping,
    document::pretty,
    log::ReadOptions,
    render::{
        kit::{argument, command},
        record as words,
    },
    workflow::{
        join,
        record::{Inputs, Part, Progress, run},
    },
};

const EXAMPLES: &str = "\
Examples:
  your_controller | hydrotrace record -o run.mcap
  hydrotrace record -o run.mcap --udp 0.0.0.0:5005 --degrees
  your_controller | hydrotrace record -o run.mcap --plan next.mcap --report

A header and rows (CSV) or an object a line (JSON) come on standard input or by UDP, a packet being one or more whole
lines. Columns are understood as by `import`, from the first lines; a unit is not guessed. Each second what came is
put on the disk. The recording ends with its input, after --seconds, or with Ctrl-C.";

/// Write what a controller sends, line by line, to a log
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Args {
    /// Write the log to LOG
    #[arg(short, long, value_name = "LOG")]
    output: PathBuf,

    /// Receive packets at ADDRESS:PORT instead of reading standard input
    #[arg(long, value_name = "ADDRESS:PORT")]
    udp: Option<String>,

    /// End after SECONDS
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    seconds: Option<f64>,

    /// Begin a new file, LOG-2 and on, after so many megabytes
    #[arg(long, value_name = "MB", value_parser = clap::value_parser!(u32).range(1..), conflicts_with = "part_minutes")]
    part_mb: Option<u32>,

    /// Begin a new file after so many whole minutes
    #[arg(long, value_name = "MINUTES", value_parser = clap::value_parser!(u32).range(1..))]
    part_minutes: Option<u32>,

    /// At the end put the plan of FILE beside the run, found by what was sent, into LOG-with-plan
    #[arg(long, value_name = "FILE")]
    plan: Option<PathBuf>,

    /// At the end print the report
    #[arg(long, conflicts_with = "json")]
    report: bool,

    /// Print what was recorded as one JSON document
    #[arg(long)]
    json: bool,

    #[command(flatten)]
    columns: ColumnArgs,
}

/// The arguments of a report.
#[derive(clap::Parser)]
struct Report {
    #[command(flatten)]
    args: report::Args,
}

impl Args {
    fn inputs(&self, replace: bool) -> Result<Inputs, CliError> {
        let bytes = self.part_mb.map(|mb| Part::Bytes(u64::from(mb) << 20));
        let part = bytes.or(self.part_minutes.map(|minutes| Part::Seconds(60.0 * f64::from(minutes))));
        Ok(Inputs { output: self.output.clone(), options: self.columns.options()?, part, replace })
    }

    /// `run.mcap` with its plan is `run-with-plan.mcap`.
    fn joined(&self) -> PathBuf {
        let stem = self.output.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        self.output.with_file_name(format!("{stem}-with-plan.mcap"))
    }

    fn join(&self, plan: &Path, logs: &[PathBuf]) -> Result<PathBuf, CliError> {
        let output = self.joined();
        let inputs = join::Inputs {
            logs: logs.to_vec(),
            plan: plan.to_owned(),
            read: ReadOptions::default(),
            at_s: None,
            output: output.clone(),
        };
        let words: Vec<String> = logs.iter().map(argument).collect();
        let line = ["join", &words.join(" "), "--plan", &argument(plan), "-o", &argument(&output)];
        let step = format!(
            "the recording is whole, but without its plan; `{}` joins them, with the option that is named below",
            command(&line)
        );
        join::run(&inputs).map_err(|error| CliError::step(step)(error.into()))?;
        Ok(output)
    }
}

impl Run for Args {
    fn run(&self, console: &mut Console<'_>) -> Result<Outcome, CliError> {
        let input = self.udp.is_none().then(|| PathBuf::from("/dev/stdin"));
        let inputs: Vec<PathBuf> = self.plan.iter().cloned().chain(input).collect();
        spare_for_log(Some(&self.output), &inputs)?;
        // What is wrong with it should not show after an hour.
        self.plan.as_deref().map(join::check_plan).transpose()?;
        let request = self.inputs(self.output.exists() || !is_keeping())?;
        super::interrupt::ask_only();
        // An end that no clock reaches is none.
        let length = self.seconds.and_then(|seconds| Duration::try_from_secs_f64(seconds).ok());
        let until = length.and_then(|length| Instant::now().checked_add(length));
        let mut lines = Lines::of(self.udp.as_deref(), &request.options, until)?;
        let bar = progress(None, "{spinner} {elapsed}  {msg}");
        bar.enable_steady_tick(Duration::from_millis(200));
        let mut shown = Instant::now();
        let recorded = run(&request, &mut lines, |now: &Progress| {
            if shown.elapsed() > Duration::from_millis(500) {
                shown = Instant::now();
                bar.set_message(words::progress(now));
            }
        });
        bar.finish_and_clear();
        let mut recorded = recorded?;
        recorded.remarks.extend(lines.remarks());
        let target = Target::stdout(self.json);
        let joined = match self.plan.as_deref().map(|plan| self.join(plan, &recorded.logs)).transpose() {
            Ok(joined) => joined,
            Err(error) => {
                // What was recorded is there all the same.
                let result = target.text(&words::document(&recorded, None));
                console.finish(&target, &result, &recorded.remarks, &[])?;
                return Err(error);
            }
        };
        let result = if self.json {
            pretty(&recorded)
        } else {
            target.text(&words::document(&recorded, joined.as_deref()))
        };
        let outcome = console.finish(&target, &result, &recorded.remarks, &[])?;
        if !self.report {
            return Ok(outcome);
        }
        let logs = joined.map_or(recorded.logs, |log| vec![log]);
        let words = std::iter::once("report".into()).chain(logs.into_iter().map(PathBuf::into_os_string));
        let report = Report::try_parse_from(words).map_err(|error| CliError::Usage(error.to_string()))?;
        console.print("\n")?;
        report.args.run(console)
    }
}
