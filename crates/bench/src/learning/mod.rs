//! Commands run after run on simulated machines of many structures: what is left of the error, beside a plain
//! proportional learning law.

mod job;
mod peer;
mod score;
mod table;

use hydrotrace::{
    arm::ArmError,
    fit::{Fit, FitError, Learning, Observation, Step, Trial, fit, learn},
    plan::PlanError,
    plant::{Parameters, Plant, PlantError, simulate},
    series::{Series, SignalError, Track},
    task::TaskError,
};
use rayon::prelude::*;
use serde::Serialize;
use thiserror::Error;

pub use job::Job;
pub use score::Score;
pub use table::table;

/// What keeps a study from its result.
#[derive(Debug, Error)]
pub enum LearningError {
    /// A task.
    #[error(transparent)]
    Task(#[from] TaskError),
    /// An arm.
    #[error(transparent)]
    Arm(#[from] ArmError),
    /// A plan.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// A machine.
    #[error(transparent)]
    Plant(#[from] PlantError),
    /// A fit or a command.
    #[error(transparent)]
    Fit(#[from] FitError),
    /// Samples.
    #[error(transparent)]
    Signal(#[from] SignalError),
}

/// Who makes the commands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Teacher {
    /// [`learn`].
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
            let cell = cell(machine, job, seed, inputs);
            done();
            cell
        })
        .collect()
}

/// Seeds of one cell's runs lie so far apart.
const SEEDS_A_CELL: u64 = 1000;

fn cell(machine: &str, job: &Job, seed: u64, inputs: &Inputs) -> Result<Cell, LearningError> {
    let plant = Plant::new(job.setup.arm(), Parameters::preset(machine)?)?;
    let tried = |sent: &Series, run: u64| -> Result<(Series, Score), LearningError> {
        let record = simulate(&plant, &held(sent)?, &job.payload, SEEDS_A_CELL * seed + run)?;
        let score = Score::of(&job.plan, &record)?;
        Ok((cut(&score::series(&record, false)?, &job.plan)?, score))
    };
    let (measured, plain) = tried(&job.plan, 0)?;
    let (_, again) = tried(&job.plan, 500)?;
    let mut logs = vec![(job.plan.clone(), measured)];
    let (mut runs, mut notes) = (Vec::new(), Vec::new());
    for run in 1..=inputs.runs {
        let (command, note) = match inputs.teacher {
            Teacher::Learn => taught(job, &logs)?,
            Teacher::Proportional => (peer::next(job, &logs)?, String::new()),
        };
        let (measured, score) = tried(&command, run)?;
        runs.push(score);
        notes.push(note);
        logs.push((command, measured));
    }
    let (machine, job) = (machine.to_owned(), job.title.to_owned());
    Ok(Cell { machine, job, seed, plain, again, runs, notes })
}

/// As the log of a run would end: some seconds after the plan.
fn cut(measured: &Series, plan: &Series) -> Result<Series, SignalError> {
    let end_s = plan.span_s().map_or(0.0, |[_, end_s]| end_s);
    let one = |track: &Track| {
        let count = track.t_s().partition_point(|t_s| *t_s <= end_s);
        Track::new(track.name(), &track.t_s()[..count], track.position()[..count].to_vec(), &[])
    };
    Ok(Series { tracks: measured.tracks.iter().map(one).collect::<Result<_, _>>()? })
}

/// What is sent, its last angle held for some time.
fn held(sent: &Series) -> Result<Series, SignalError> {
    let one = |track: &Track| {
        let last = track.t_s().last().copied().unwrap_or_default();
        let state = track.held_at(last);
        let t_s: Vec<f64> = track.t_s().iter().copied().chain([last + 0.01, last + score::HELD_S]).collect();
        let angle = track.position().iter().copied().chain([state.position; 2]).collect();
        let speed = track.velocity().unwrap_or_default().iter().copied().chain([0.0; 2]).collect();
        Track::new(track.name(), t_s, angle, &[])?.with_velocity(speed)
    };
    Ok(Series { tracks: sent.tracks.iter().map(one).collect::<Result<_, _>>()? })
}

fn fitted(logs: &[(Series, Series)]) -> Result<Fit, FitError> {
    let observed: Vec<Observation> =
        logs.iter().map(|(sent, measured)| Observation { sent, measured, valve: &[] }).collect();
    fit(&observed)
}

fn taught(job: &Job, logs: &[(Series, Series)]) -> Result<(Series, String), LearningError> {
    let trials: Vec<Trial> = logs.iter().map(|(sent, measured)| Trial { sent, measured }).collect();
    let found = learn(&fitted(&logs[..1])?, &job.plan, &trials, Learning::default(), |_| None)?;
    let note = |joint: &hydrotrace::fit::JointStep| {
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
            Step::Kept { from } => format!("kept {from}"),
            Step::None => "none".to_owned(),
        };
        format!("{}: {step}{rings}", joint.name)
    };
    let notes: Vec<String> = found.joints.iter().map(note).collect();
    Ok((found.command(&job.plan, |_| 1.0)?, notes.join("; ")))
}

/// The plan with corrections, by joint and step.
fn sent(plan: &Series, corrections: &[&[[f64; 3]]]) -> Result<Series, SignalError> {
    let one = |(track, correction): (&Track, &&[[f64; 3]])| {
        let add = |values: &[f64], k: usize| {
            values
                .iter()
                .zip(*correction)
                .map(|(value, correction)| value + correction[k])
                .collect::<Vec<f64>>()
        };
        let speed = add(track.velocity().unwrap_or_default(), 1);
        Track::new(track.name(), track.t_s(), add(track.position(), 0), &[])?.with_velocity(speed)
    };
    Ok(Series { tracks: plan.tracks.iter().zip(corrections).map(one).collect::<Result<_, _>>()? })
}
