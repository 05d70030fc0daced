//! `demo`: the whole loop by the verbs themselves, on a simulated machine.

use std::{io::Write, path::Path};

use clap::Parser;

use super::{
    CliError, Outcome,
    args::{Args, Command, CompareArgs, DemoArgs, FitArgs, PlanArgs, ReplanArgs, SimulateArgs},
    fit,
    output::{deliver, progress, shown},
    plan, replan, simulate,
};
use crate::{
    atomic_file::write_atomically,
    render::demo::{Story, document},
    workflow::{
        compare::{Inputs, run as compare},
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

pub(super) fn run(args: &DemoArgs, out: &mut impl Write) -> Result<Outcome, CliError> {
    let dir = &args.dir;
    std::fs::create_dir_all(dir).map_err(|source| CliError::Folder { path: dir.clone(), source })?;
    write_atomically(&dir.join(TASK), |file| Ok::<(), CliError>(file.write_all(SAMPLE_TASK.as_bytes())?))?;
    let bar = progress(None, "{spinner} {msg}");
    bar.enable_steady_tick(std::time::Duration::from_millis(100));
    let say = |words: &[&str]| bar.set_message(format!("hydrotrace {}", words.join(" ")));
    let seeds = [args.seed, args.seed.wrapping_add(1)].map(|seed| seed.to_string());
    let machine = |plan, run, seed| ["simulate", plan, "-o", run, "--plant", &args.plant, "--seed", seed];
    let (first, second) = (machine(PLAN, RUN, &seeds[0]), machine(NEXT, NEXT_RUN, &seeds[1]));

    let words = ["plan", TASK, "-o", PLAN];
    say(&words);
    let planned =
        plan::found(&made(dir, &words)?, &PlanRequest::read(&dir.join(TASK))?, &mut std::io::sink())?;
    say(&first);
    simulate::simulated(&made(dir, &first)?)?;
    let words = ["fit", RUN, "-o", LIMITS];
    say(&words);
    let fitted = fit::fitted(&made(dir, &words)?)?;
    let words = ["replan", RUN, "--limits", LIMITS, "-o", NEXT];
    say(&words);
    let replanned = replan::replanned(&made(dir, &words)?)?;
    say(&second);
    simulate::simulated(&made(dir, &second)?)?;
    let words = ["compare", RUN, NEXT_RUN];
    say(&words);
    let CompareArgs { before, after, .. } = made(dir, &words)?;
    let comparison = compare(&Inputs { before: vec![before], after: vec![after], ..Inputs::default() })?;
    bar.finish_and_clear();

    let story = Story {
        dir,
        machine: [&first, &second].map(|words| words.join(" ")),
        planned: &planned.planned,
        fitted: &fitted,
        replanned: &replanned,
        comparison: &comparison,
    };
    deliver(&shown(&document(&story), None), None, out)?;
    Ok(if replanned.remarks.is_empty() { Outcome::Clean } else { Outcome::Remarks })
}

/// Arguments of a verb, as its words give them within a folder.
fn made<T: Verb>(dir: &Path, words: &[&str]) -> Result<T, CliError> {
    let inside = |word: &&str| {
        let file = [TASK, PLAN, RUN, LIMITS, NEXT, NEXT_RUN].contains(word);
        if file { dir.join(word).into_os_string() } else { word.into() }
    };
    let words = std::iter::once("hydrotrace".into()).chain(words.iter().map(inside));
    let args = Args::try_parse_from(words).map_err(|error| CliError::Words(error.to_string()))?;
    T::of(args.command).ok_or_else(|| CliError::Words("another verb was meant".into()))
}

/// The arguments of one verb.
trait Verb: Sized {
    fn of(command: Command) -> Option<Self>;
}

macro_rules! verbs {
    ($($args:ident $name:ident),*) => {$(
        impl Verb for $args {
            fn of(command: Command) -> Option<Self> {
                match command {
                    Command::$name(args) => Some(args),
                    _ => None,
                }
            }
        }
    )*};
}

verbs!(PlanArgs Plan, SimulateArgs Simulate, FitArgs Fit, ReplanArgs Replan, CompareArgs Compare);
