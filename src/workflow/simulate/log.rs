//! `simulate`: from the log of a plan to a run of it, and to the run's log.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

use thiserror::Error;

use super::super::{
    carried::{
        Carried,
        rest::{RUN_LEAD_S, RUN_TAIL_S},
    },
    plan::PlanFailure,
    simulate::{Content, Inputs, Outputs, run},
};
use crate::{
    arm::Arm,
    log::{LogError, ReadOptions, SignalRole, WantedSignal, WriteError, WriteOptions, read_plan},
    plan::{PlanError, Setup},
    plant::{Parameters, PayloadChange, Plant, PlantError},
    remark::Remarks,
    series::{Series, SignalError, Track},
    task::{Task, TaskError},
};

/// Why nothing was simulated.
#[derive(Debug, Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the message says what each field is")]
pub enum SimulateFailure {
    #[error(transparent)]
    Log(#[from] LogError),
    #[error("{} holds a broken task", path.display())]
    Task { path: PathBuf, source: TaskError },
    #[error(transparent)]
    Arm(#[from] PlanFailure),
    #[error("the task in the log does not fit its plan")]
    Setup(#[from] PlanError),
    #[error(
        "{} holds no task and so no arm; its joints are {found}, those of the sample arm {sample}. Give a log of \
         `plan`, `replan --task` or `excite --task`",
        path.display()
    )]
    NoArm { path: PathBuf, found: String, sample: String },
    #[error(transparent)]
    Plant(#[from] PlantError),
    #[error("the run cannot be logged")]
    Write(#[from] WriteError),
    #[error("the plan in the log cannot be run")]
    Track(#[from] SignalError),
}

/// A run, and the files of the plan that go with it.
#[derive(Debug, Clone)]
pub struct Run {
    /// What came of it.
    pub outputs: Outputs,
    /// What was run.
    pub prepared: Prepared,
}

impl Run {
    /// The run as an MCAP log, with the files of its plan.
    ///
    /// # Errors
    ///
    /// [`WriteError`] for joint names that no log can hold.
    pub fn log(&self) -> Result<Vec<u8>, WriteError> {
        let Prepared { carried, arm, .. } = &self.prepared;
        self.outputs.log(carried, Some(&arm.chain), Content::Everything, WriteOptions::default())
    }
}

/// Runs the plan of a log, or the command beside it, on a machine around the arm of the log's task; the
/// sample arm where the log has no task.
///
/// # Errors
///
/// [`SimulateFailure`], naming what is missing.
pub fn simulate(path: &Path, parameters: Parameters, seed: u64) -> Result<Run, SimulateFailure> {
    prepare(path, parameters, seed)?.run()
}

/// A run that is yet to be made.
#[derive(Debug, Clone)]
pub struct Prepared {
    /// What to run on which machine, rests counted.
    pub inputs: Inputs,
    /// What the plan's log carries, with when its times count from in this run.
    pub carried: Carried,
    /// Whether the log holds a command that is not the plan.
    pub commanded: bool,
    /// The arm that is to run it.
    pub arm: Arm,
    /// Doubts about the plan's log.
    pub remarks: Remarks,
}

impl Prepared {
    /// Makes the run.
    ///
    /// # Errors
    ///
    /// [`SimulateFailure::Plant`].
    pub fn run(self) -> Result<Run, SimulateFailure> {
        Ok(Run { outputs: run(&self.inputs)?, prepared: self })
    }
}

/// What [`simulate`] runs.
///
/// # Errors
///
/// As [`simulate`].
pub fn prepare(path: &Path, parameters: Parameters, seed: u64) -> Result<Prepared, SimulateFailure> {
    let signals = vec![WantedSignal::usual(SignalRole::Command)];
    let plan = read_plan(&[path.to_owned()], &ReadOptions { signals, ..ReadOptions::default() })?;
    let carried = Carried::of(&plan);
    let starts_s = RUN_LEAD_S + carried.starts_s().unwrap_or(0.0);
    let promised = carried.promise();
    let mut carried = carried.with_provenance(BTreeMap::new()).with_starts_s(starts_s);
    if let Some(promised) = promised {
        carried = carried.with_promise(&promised);
    }
    let mut remarks = Remarks::default();
    let (arm, payload) = match carried.task_or_arm() {
        None => (sample_arm(path, &plan.planned)?, Vec::new()),
        Some(task) => {
            let task = task.map_err(|source| SimulateFailure::Task { path: path.to_owned(), source })?;
            carried.remark_others(path, &mut remarks);
            let arm = carried.task_files().unwrap_or_default().arm(&task)?;
            let payload = carried
                .times_s()
                .map_or(Ok(Vec::new()), |times_s| payload(&task, arm.clone(), &times_s, starts_s))?;
            (arm, payload)
        }
    };
    let planned = with_rests(&plan.planned)?;
    let commanded = plan.command.is_some();
    let command = plan.command.as_ref();
    let command = command.map_or(Ok(planned.clone()), |command| with_rests(&command.series))?;
    let plant = Plant::new(&arm, parameters)?;
    let inputs = Inputs { plant, plan: planned, command, payload, seed };
    Ok(Prepared { inputs, carried, commanded, arm, remarks })
}

/// The sample arm, for a log that names no other and whose joints are its.
fn sample_arm(path: &Path, planned: &Series) -> Result<Arm, SimulateFailure> {
    let arm = Arm::sample().map_err(PlanFailure::from)?;
    let names: Vec<&str> = arm.chain.joints().iter().map(|joint| joint.name.as_str()).collect();
    if names.iter().all(|name| planned.track(name).is_some()) {
        return Ok(arm);
    }
    let found: Vec<&str> = planned.tracks.iter().map(Track::name).collect();
    let (found, sample) = (found.join(", "), names.join(", "));
    Err(SimulateFailure::NoArm { path: path.to_owned(), found, sample })
}

/// Payloads with their times, rests counted.
fn payload(task: &Task, arm: Arm, times_s: &[f64], starts_s: f64) -> Result<Vec<PayloadChange>, PlanError> {
    let setup = Setup::new(task, arm)?;
    let motion = setup.motion(times_s)?;
    let starts = motion.segments().iter().zip(setup.payload_kg());
    Ok(starts
        .enumerate()
        .map(|(i, (segment, &mass_kg))| PayloadChange {
            at_s: if i == 0 { 0.0 } else { starts_s + segment.start_s },
            mass_kg,
        })
        .collect())
}

/// The same with rests before and after; speeds that a track lacks are those of its interpolation.
fn with_rests(series: &Series) -> Result<Series, SignalError> {
    let first_s = |track: &Track| track.t_s().first().copied().unwrap_or(0.0);
    let ends_s = series.tracks.iter().filter_map(|track| Some(track.t_s().last()? - first_s(track)));
    let end_s = ends_s.fold(0.0, f64::max);
    let tracks = series.tracks.iter().map(|track| {
        let step_s = track.sample_interval_s().clamp(1e-3, 0.1);
        let mut t_s = vec![0.0];
        t_s.extend(track.t_s().iter().map(|t_s| RUN_LEAD_S + t_s - first_s(track)));
        t_s.push(RUN_LEAD_S + end_s + step_s);
        t_s.push(RUN_LEAD_S + end_s + RUN_TAIL_S);
        let states: Vec<_> = t_s.iter().map(|t| track.held_at(t - RUN_LEAD_S + first_s(track))).collect();
        let position_rad = states.iter().map(|state| state.position).collect();
        let velocity_rad_s = states.iter().map(|state| state.velocity).collect();
        Track::new(track.name().to_owned(), t_s, position_rad, &[])?.with_velocity(velocity_rad_s)
    });
    Ok(Series { tracks: tracks.collect::<Result<_, _>>()? })
}
