//! Commands run after run on simulated machines of many structures, by the verbs that a user calls: what is left of the
//! error, and what was promised of it, beside a plain proportional learning law.

mod job;
mod machine;
mod peer;
mod score;
mod table;

use std::{
    collections::BTreeMap,
    io,
    ops::ControlFlow,
    path::{Path, PathBuf},
};

use hydrotrace::{
    fit::{FitError, Step},
    log::WriteError,
    plan::PlanError,
    plant::PlantError,
    series::SignalError,
    threads,
    units::degrees_from_radians,
    workflow::{
        plan::PlanFailure,
        replan::{JointCommand, ReplanFailure, Replanned},
        simulate::log::SimulateFailure,
    },
};
use rayon::prelude::*;
use serde::Serialize;
use thiserror::Error;

pub use job::Job;
use machine::{Machine, Ran};
pub use score::Score;
pub use table::table;

/// What keeps a study from its result.
#[derive(Debug, Error)]
pub enum LearningError {
    /// A task.
    #[error(transparent)]
    Task(#[from] PlanFailure),
    /// A plan.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// A machine.
    #[error(transparent)]
    Plant(#[from] PlantError),
    /// A fit.
    #[error(transparent)]
    Fit(#[from] FitError),
    /// A run.
    #[error(transparent)]
    Simulate(#[from] SimulateFailure),
    /// A command.
    #[error(transparent)]
    Replan(#[from] ReplanFailure),
    /// Samples.
    #[error(transparent)]
    Signal(#[from] SignalError),
    /// A log.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// A file between two verbs.
    #[error("a log of the study cannot be written")]
    File(#[from] io::Error),
}

/// Who makes the commands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Teacher {
    /// `replan`, from the logs of all runs so far.
    Learn,
    /// Proportional iterative learning.
    Proportional,
}

/// One machine, plan and seed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Cell {
    /// Preset of the machine.
    pub machine: String,
    /// The plan.
    pub job: String,
    /// Of noise, losses and what changes from run to run.
    pub seed: u64,
    /// The plan sent as it is, again with another seed, then each run with a command.
    pub plain: Score,
    /// The plan once more, with another seed.
    pub again: Score,
    /// Runs with commands, in their order.
    pub runs: Vec<Score>,
    /// Mean peak that each command promised, and what nine runs of ten stay below, deg.
    pub promised_deg: Vec<Option<[f64; 2]>>,
    /// How each joint's correction came about, by run.
    pub notes: Vec<String>,
}

/// What to try.
#[derive(Debug, Clone)]
pub struct Inputs {
    /// Presets.
    pub machines: Vec<String>,
    /// Plans by index.
    pub jobs: Vec<usize>,
    /// Seeds.
    pub seeds: Vec<u64>,
    /// Runs with commands.
    pub runs: u64,
    /// Who makes them.
    pub teacher: Teacher,
}

/// Runs all cells.
///
/// # Errors
///
/// [`LearningError`].
pub fn run(inputs: &Inputs, done: impl Fn() + Sync) -> Result<Vec<Cell>, LearningError> {
    let jobs = Job::all()?;
    let mut cells = Vec::new();
    for machine in &inputs.machines {
        for &job in &inputs.jobs {
            cells.extend(inputs.seeds.iter().filter_map(|&seed| Some((machine, jobs.get(job)?, seed))));
        }
    }
    cells
        .into_par_iter()
        .map(|(machine, job, seed)| {
            // A thread that waits for a part of its cell would take on another cell, and its stack would grow with each.
            let cell = threads::alone(|| cell(machine, job, seed, inputs));
            done();
            cell
        })
        .collect()
}

/// Seeds of one cell's runs lie so far apart.
const SEEDS_A_CELL: u64 = 1000;

/// Seed of the plan's second run, beside those of the runs with commands.
const AGAIN: u64 = 500;

fn cell(name: &str, job: &Job, seed: u64, inputs: &Inputs) -> Result<Cell, LearningError> {
    let folder = tempfile::tempdir()?;
    let file = |name: String, bytes: &[u8]| -> Result<PathBuf, LearningError> {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes)?;
        Ok(path)
    };
    let plan = file("plan.mcap".to_owned(), &job.log)?;
    let machine = Machine { name, seed: SEEDS_A_CELL * seed };
    let plain = machine.runs(&plan, 0, None)?;
    let again = machine.runs(&plan, AGAIN, None)?.score;
    let mut logs = vec![file("run-0.mcap".to_owned(), &plain.log)?];
    let mut all: Vec<Ran> = vec![plain];
    let (mut promised_deg, mut notes) = (Vec::new(), Vec::new());
    for run in 1..=inputs.runs {
        let ran = match inputs.teacher {
            Teacher::Learn => {
                let next = replanned(&logs)?;
                let sent = file(format!("next-{run}.mcap"), &next.log(BTreeMap::new(), 100.0)?)?;
                let promise = next.promise();
                promised_deg.push(Some(
                    [promise.mean_peak_rad, promise.mean_peak_margin_rad].map(degrees_from_radians),
                ));
                notes.push(note(&next));
                machine.runs(&sent, run, None)?
            }
            Teacher::Proportional => {
                promised_deg.push(None);
                notes.push(String::new());
                machine.runs(&plan, run, Some(peer::next(&all)?))?
            }
        };
        logs.push(file(format!("run-{run}.mcap"), &ran.log)?);
        all.push(ran);
    }
    let mut scores = all.into_iter().map(|ran| ran.score);
    let plain = scores.next().unwrap_or_else(|| again.clone());
    let (machine, job) = (name.to_owned(), job.title.to_owned());
    Ok(Cell { machine, job, seed, plain, again, runs: scores.collect(), promised_deg, notes })
}

fn replanned(logs: &[PathBuf]) -> Result<Replanned, LearningError> {
    let inputs = hydrotrace::workflow::replan::Inputs {
        logs: logs.iter().map(PathBuf::as_path).map(Path::to_owned).collect(),
        keep_plan: true,
        ..Default::default()
    };
    Ok(hydrotrace::workflow::replan::run(&inputs, |_| ControlFlow::Continue(()))?)
}

fn note(next: &Replanned) -> String {
    let of = |joint: &JointCommand| {
        let rings = joint.oscillation.map_or(String::new(), |o| {
            format!(
                " a1 {:.2} a2 {:.2} {:.2} Hz {:?}",
                o.first_minimum, o.next_maximum, o.frequency_hz, o.character
            )
        });
        let step = match joint.step {
            Step::Model => "model".to_owned(),
            Step::First { model_weight } => format!("first {model_weight:.2}"),
            Step::Later { from, gain } => format!("later {from} {gain:.2}"),
            Step::Rest { from, share } => format!("rest {from} {share:.2}"),
            Step::Kept { from, .. } => format!("kept {from}"),
            Step::Astray => "astray".to_owned(),
            Step::None => "none".to_owned(),
        };
        format!("{}: {step}, share {:.2}{rings}", joint.name, joint.share)
    };
    next.command.iter().flat_map(|command| &command.joints).map(of).collect::<Vec<_>>().join("; ")
}
