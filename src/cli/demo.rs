//! `demo`: the whole loop by the verbs themselves, on a simulated machine.

use std::path::{Path, PathBuf};

use clap::Parser;

use super::{
    CliError, Command, Outcome, Run, compare,
    console::{Console, make_folder, progress, write_file},
    fit, plan, replan, simulate,
};
use crate::{
    input_file,
    render::{
        compare::page as compare_page,
        demo::{Story, document},
    },
    workflow::{
        compare::run as compare_runs,
        plan::{PlanRequest, SAMPLE_TASK},
    },
};

/// Files, in the order in which they are made.
const TASK: &str = "task-1.toml";
const PLAN: &str = "plan.mcap";
const RUN: &str = "run-1.mcap";
const LIMITS: &str = "limits.toml";
const NEXT: &str = "next.mcap";
const NEXT_RUN: &str = "run-2.mcap";
const PAGE: &str = "compare.html";

/// The whole loop on a simulated machine, from plan to comparison
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// Leave the files in DIR
    #[arg(long, value_name = "DIR", default_value = "hydrotrace-demo")]
    dir: PathBuf,

    /// The machine: one of those of the guide, such as lag-limited or soft, or a TOML file
    #[arg(long, value_name = "PLANT", default_value = "default")]
    plant: String,

    /// Seed of noise, jitter and lost messages; the second run uses the next one
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

impl Run for Args {
    fn run(&self, console: &mut Console<'_>) -> Result<Outcome, CliError> {
        let dir = &self.dir;
        make_folder(dir)?;
        begin(dir)?;
        let bar = progress(None, "{spinner} {msg}");
        bar.enable_steady_tick(std::time::Duration::from_millis(100));
        let say = |words: &[&str]| bar.set_message(format!("hydrotrace {}", words.join(" ")));
        let seeds = [self.seed, self.seed.wrapping_add(1)].map(|seed| seed.to_string());
        let machine = |plan, run, seed| ["simulate", plan, "-o", run, "--plant", &self.plant, "--seed", seed];
        let (first, second) = (machine(PLAN, RUN, &seeds[0]), machine(NEXT, NEXT_RUN, &seeds[1]));

        let words = ["plan", TASK, "-o", PLAN];
        say(&words);
        let request = PlanRequest::read(&dir.join(TASK))?;
        let found = made::<plan::Args>(dir, &words)?.found(&request, console)?;
        say(&first);
        made::<simulate::Args>(dir, &first)?.simulated()?;
        let words = ["fit", RUN, "-o", LIMITS];
        say(&words);
        let fitted = made::<fit::Args>(dir, &words)?.fitted()?;
        let words = ["replan", RUN, "--limits", LIMITS, "-o", NEXT];
        say(&words);
        let replanned = made::<replan::Args>(dir, &words)?.replanned()?;
        say(&second);
        made::<simulate::Args>(dir, &second)?.simulated()?;
        let words = ["compare", RUN, NEXT_RUN];
        say(&words);
        let comparison = compare_runs(&made::<compare::Args>(dir, &words)?.request())?;
        let logs = [RUN, NEXT_RUN].map(PathBuf::from);
        let page = compare_page(&comparison, compare::MOST[1], [&logs[..1], &logs[1..]], &[]);
        write_file(&dir.join(PAGE), page.as_bytes())?;
        bar.finish_and_clear();

        console.show(&document(&Story {
            dir,
            machine: [&first, &second].map(|words| words.join(" ")),
            planned: &found.planned,
            fitted: &fitted,
            replanned: &replanned,
            comparison: &comparison,
        }))?;
        Ok(if replanned.remarks.is_empty() { Outcome::Clean } else { Outcome::Remarks })
    }
}

/// Writes the task. Where an earlier demo did, removes the command that it left; of another one the same name stays,
/// and is not replaced.
fn begin(dir: &Path) -> Result<(), CliError> {
    let (task, next) = (dir.join(TASK), dir.join(NEXT));
    if !input_file::read_to_string(&task).is_ok_and(|text| text == SAMPLE_TASK) {
        return write_file(&task, SAMPLE_TASK.as_bytes());
    }
    let failed = CliError::step(format!("cannot replace {}", next.display()));
    if next.is_file() { std::fs::remove_file(next).map_err(|error| failed(error.into())) } else { Ok(()) }
}

/// The arguments of a verb from its words, with files in a folder.
fn made<T: TryFrom<Command, Error = CliError>>(dir: &Path, words: &[&str]) -> Result<T, CliError> {
    let inside = |word: &&str| {
        let file = [TASK, PLAN, RUN, LIMITS, NEXT, NEXT_RUN].contains(word);
        if file { dir.join(word).into_os_string() } else { word.into() }
    };
    let words = std::iter::once("hydrotrace".into()).chain(words.iter().map(inside));
    super::Args::try_parse_from(words)?.command.try_into()
}
