//! `replan`

use std::{
    collections::BTreeMap,
    ffi::OsString,
    ops::ControlFlow,
    path::{Path, PathBuf},
};

use super::{
    CliError, Outcome, Run,
    console::{Console, Target, progress, spare_for_log, spare_for_page, write_file},
    number::{correction_deg, correction_mm, growth_percent, share},
    plan::Free,
    read::SentArgs,
};
use crate::{
    fit::Learning,
    render::{kit, next, replan as words},
    workflow::replan::{Checks, Commanded, Inputs, ReplanDocument, Replanned, run},
};

const EXAMPLES: &str = "\
Examples:
  hydrotrace replan run.mcap -o next.mcap
  hydrotrace replan run.mcap -o next.mcap --gain 0.5
  hydrotrace replan field.mcap -o next.mcap --keep-plan
  hydrotrace replan run-1.mcap run-2.mcap run-3.mcap -o next.mcap
  hydrotrace replan run-1.mcap run-2.mcap --limits limits.toml --task task.toml -o next.mcap";

/// Samples a second in the log; that of the control loops that commands are sent to.
const RATE_HZ: f64 = 100.0;

/// Plan and command for the next run, from logs of the last ones
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Args {
    /// Logs of runs of one machine, each a file or a bag directory, in their order where their stamps say no date; the plan is that of the last
    #[arg(required = true, value_name = "RUN")]
    logs: Vec<PathBuf>,

    /// Write plan and command to FILE, an MCAP log with both as channels of their own
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,

    /// Machine from FILE, which `fit` wrote, instead of a fit of the runs
    #[arg(long, value_name = "FILE")]
    limits: Option<PathBuf>,

    /// The task, instead of the one in the last log
    #[arg(long, value_name = "FILE")]
    task: Option<PathBuf>,

    /// One JSON document (schemas/replan.v3.schema.json in the repository)
    #[arg(long)]
    json: bool,

    /// Write one page for a browser to FILE: verdict, checklist, plots with limits; needs no network
    #[arg(long, value_name = "FILE")]
    html: Option<PathBuf>,

    #[command(flatten)]
    change: ChangeArgs,

    #[command(flatten)]
    sent: SentArgs,
}

#[derive(Debug, clap::Args)]
#[command(next_help_heading = "What may change")]
struct ChangeArgs {
    /// Change only the command; needs no task and works on any log with planned and measured joints
    #[arg(long, conflicts_with = "no_precompensation")]
    keep_plan: bool,

    /// Change only the plan, for controllers that take no separate command
    #[arg(long)]
    no_precompensation: bool,

    /// Search other timings though runs of this plan were corrected already; learning starts anew
    #[arg(long, conflicts_with = "keep_plan")]
    retime: bool,

    /// What a new plan is free in beside the times at the key points [default: the same as the last plan]
    #[arg(long, value_name = "WHAT", conflicts_with = "keep_plan")]
    shape: Option<Free>,

    /// Share of the correction to apply, 0 to 1; 0.5 for a cautious first run
    #[arg(long, value_name = "SHARE", default_value_t = 1.0, value_parser = share)]
    gain: f64,

    /// Largest difference between command and plan [default: 1.25 times the largest error, at least 1.5]
    #[arg(long, value_name = "DEG", value_parser = correction_deg, allow_negative_numbers = true)]
    max_correction_deg: Option<f64>,

    /// The same of joints that slide [default: 1.25 times the largest error, at least 26]
    #[arg(long, value_name = "MM", value_parser = correction_mm, allow_negative_numbers = true)]
    max_correction_mm: Option<f64>,

    /// Largest growth of the plan's duration
    #[arg(long, value_name = "PERCENT", default_value = "0", value_parser = growth_percent)]
    max_time_growth_percent: f64,

    /// Largest growth of its jerk and of its power
    #[arg(long, value_name = "PERCENT", default_value = "10", value_parser = growth_percent)]
    max_cost_growth_percent: f64,

    /// Evaluations of the search; 15 % of them predict start errors
    #[arg(long, value_name = "N", default_value_t = 20_000, value_parser = clap::value_parser!(u64).range(1000..=100_000_000))]
    evaluations: u64,

    /// Seed of the search
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

impl ChangeArgs {
    /// Options that hold for the next command, too: a task that no log holds, the machine, bounds, and what must not change. A plan that was
    /// `retimed` has taken the time that it was allowed.
    fn words_of_next(&self, task: Option<&Path>, limits: Option<&Path>, retimed: bool) -> Vec<String> {
        let mut words = Vec::new();
        if let Some(task) = task {
            words.extend(["--task".to_owned(), kit::argument(task)]);
            // Without one the plan is kept in any case.
            words.extend(self.keep_plan.then(|| "--keep-plan".to_owned()));
        }
        if let Some(limits) = limits {
            words.extend(["--limits".to_owned(), kit::argument(limits)]);
        }
        let plain = |value: f64| (1e9 * value).round() / 1e9;
        if let Some(most_rad) = self.max_correction_deg {
            words.push(format!("--max-correction-deg={}", plain(most_rad.to_degrees())));
        }
        if let Some(most_m) = self.max_correction_mm {
            words.push(format!("--max-correction-mm={}", plain(1e3 * most_m)));
        }
        if self.no_precompensation {
            words.push("--no-precompensation".to_owned());
        }
        let growths =
            [("time", self.max_time_growth_percent, 0.0), ("cost", self.max_cost_growth_percent, 0.1)];
        for (what, share, usual) in growths {
            if (share - usual).abs() > 1e-12 && !(what == "time" && retimed) {
                words.push(format!("--max-{what}-growth-percent={}", plain(100.0 * share)));
            }
        }
        words
    }
}

impl Args {
    fn request(&self) -> Inputs {
        let change = &self.change;
        let (most_rad, most_m) = (change.max_correction_deg, change.max_correction_mm);
        let learning = Learning { gain: change.gain, most_rad, most_m, ..Learning::default() };
        Inputs {
            logs: self.logs.clone(),
            read: self.sent.options(),
            limits: self.limits.clone(),
            task: self.task.clone(),
            keep_plan: change.keep_plan,
            precompensate: !change.no_precompensation,
            retime: change.retime,
            shape: change.shape.map(|shape| shape.shaping(None)),
            learning,
            time_growth: change.max_time_growth_percent,
            cost_growth: change.max_cost_growth_percent,
            evaluations: change.evaluations,
            seed: change.seed,
            ..Inputs::default()
        }
    }

    pub(super) fn replanned(&self) -> Result<Replanned, CliError> {
        let request = self.request();
        let read: Vec<PathBuf> = self.logs.iter().chain(&self.limits).chain(&self.task).cloned().collect();
        spare_for_log(self.output.as_deref(), &read)?;
        spare_for_page(self.html.as_deref(), self.output.as_deref(), &read)?;
        let bar = progress(Some(request.evaluations), "{bar:30} {pos} evaluations");
        let replanned = run(&request, |evaluations| {
            bar.set_position(evaluations);
            ControlFlow::Continue(())
        });
        bar.finish_and_clear();
        let replanned = replanned?;
        if let Some(path) = &self.output {
            let provenance = [
                ("fitted_to", replanned.fitted_to.join(", ")),
                ("retimed", replanned.retimed.to_string()),
                ("precompensated", replanned.command.as_ref().is_some_and(Commanded::applied).to_string()),
                ("gain", request.learning.gain.to_string()),
                ("seed", request.seed.to_string()),
            ];
            let provenance = BTreeMap::from(provenance.map(|(key, value)| (key.to_owned(), value)));
            write_file(path, &replanned.log(provenance, RATE_HZ)?)?;
        }
        Ok(replanned)
    }
}

impl Run for Args {
    fn run(&self, console: &mut Console<'_>) -> Result<Outcome, CliError> {
        let replanned = self.replanned()?;
        let target = Target::stdout(self.json);
        let (reading, changing) = (
            self.sent.words_of_next(),
            self.change.words_of_next(self.task.as_deref(), self.limits.as_deref(), replanned.retimed),
        );
        let again = again(std::env::args_os().skip(1));
        let lines = next::Words { again: &again, reading: &reading, changing: &changing };
        let half = Checks::of(&replanned).half_first();
        if let Some(file) = &self.html {
            let sending = next::to_send(self.output.as_deref(), &self.logs, &lines, half);
            write_file(file, words::page(&replanned, &sending).as_bytes())?;
        }
        let result = match &self.output {
            _ if self.json => ReplanDocument::of(&replanned).json(),
            Some(path) => {
                let next = next::next_written(path, &self.logs, &lines, half);
                target.text(&words::document(&replanned).with_above_remarks(next))
            }
            None => target.text(&words::document(&replanned)),
        };
        console.finish(&target, &result, &replanned.remarks, &[])
    }
}

/// Options that say how much is sent and where it goes, and whether a value follows.
const OWN: [(&str, bool); 10] = [
    ("--gain", true),
    ("--output", true),
    ("-o", true),
    ("--html", true),
    ("--force", false),
    ("--json", false),
    ("--quiet", false),
    ("-q", false),
    ("--verbose", false),
    ("-v", false),
];

/// The command line without them, its words as a shell needs them.
fn again(words: impl Iterator<Item = OsString>) -> Vec<String> {
    let mut kept = Vec::new();
    let mut words = words.map(|word| word.to_string_lossy().into_owned());
    while let Some(word) = words.next() {
        // A short option may have its value or other ones behind it.
        let is = |own: &str| {
            let glued = if own.starts_with("--") { format!("{own}=") } else { own.to_owned() };
            word == own || word.starts_with(&glued)
        };
        match OWN.iter().find(|(own, _)| is(own)) {
            Some((own, true)) if word == *own => drop(words.next()),
            Some(_) => {}
            // What begins with a dash is an option or the value of one.
            None => kept.push(kit::word(&word)),
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_careful_step_keeps_every_option_but_size_and_files() {
        let line = [
            "replan", "my run.mcap", "--gain", "1", "-o", "a.mcap", "--html=b.html", "-oother.mcap", "-vv",
            "--joints=a b", "--keep-plan", "--force",
        ];
        let kept = again(line.into_iter().map(OsString::from));
        assert_eq!(kept, ["replan", "'my run.mcap'", "'--joints=a b'", "--keep-plan"]);
    }
}
