//! `fit`: from logs of runs to what the machine does with what it is sent.

use std::{borrow::Borrow, path::PathBuf};

use serde::{Deserialize, Serialize};
mod document;
mod failure;
pub mod observe;
mod supply;
pub mod torque;

pub use document::{FitDocument, LimitsFile};
pub use failure::FitFailure;

use crate::{
    fit::{Fit, FitError, HeldOut, JointFit, Observation, Trial, fit_and_held_out, half_astray},
    log::{ReadOptions, Recording, SignalRole, SourceInfo},
    math::range,
    remark::{Code, Remarks},
    replay::Rules,
    series::{Series, Track},
    workflow::{
        carried::Carried,
        correctable::uncorrectable,
        leads::doubt_leads,
        names::told_apart,
        same_plan::{SAME_RAD, is_again},
        useless::{LeftOut, dead, stopped, twice},
    },
};
use {
    observe::ObserveFailure,
    torque::{JointTorque, torques},
};
pub(in crate::workflow) use {observe::observation, supply::supply_of};

/// Format of every file with limits.
const LIMITS_FORMAT: &str = "hydrotrace.limits.v1";

/// What to fit.
#[derive(Debug, Clone, Default)]
pub struct Inputs {
    /// Runs, each a file or a bag directory.
    pub logs: Vec<PathBuf>,
    /// What to read of each.
    pub read: ReadOptions,
}

/// A run that was fitted.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct FittedRun {
    /// Name of its log.
    pub log: String,
    /// Where plan and measurement come from.
    pub source: SourceInfo,
    /// Whether a command beside the plan was taken as what was sent.
    pub commanded: bool,
    /// Whether signals to the valves were read.
    pub valves: bool,
    /// Whether it is an identification run.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub identifies: bool,
}

/// A fit, and what it was made from.
#[derive(Debug, Clone, PartialEq)]
pub struct Fitted {
    /// The machine.
    pub fit: Fit,
    /// Prediction beside measurement where it was held out of the fit.
    pub held_out: Vec<HeldOut>,
    /// Torques by joint, of the first run that has pressures and a task with cylinders.
    pub torques: Vec<JointTorque>,
    /// The runs.
    pub runs: Vec<FittedRun>,
    /// Runs of the plan that can be planned again, in their order: that of the last one that holds its task, or else of the
    /// last; none that does not belong to its plan, or whose plan is broken.
    pub again: Vec<usize>,
    /// Whether something else than the plan was sent in one of them: learning has begun.
    pub corrected: bool,
    /// The last log, and why its run cannot be planned again, where none can.
    pub not_again: Option<String>,
    /// Doubts about the data.
    pub remarks: Remarks,
}

/// Reads and fits all runs at once.
///
/// # Errors
///
/// [`FitFailure`] naming the log.
///
/// ```
/// use hydrotrace::workflow::fit::{Inputs, run};
///
/// let logs = vec!["sample-logs/identification-run.mcap".into()];
/// let machine = run(&Inputs { logs, ..Inputs::default() })?;
/// assert!(machine.fit.joints.iter().all(|joint| joint.trusted()));
/// # Ok::<(), hydrotrace::workflow::fit::FitFailure>(())
/// ```
pub fn run(inputs: &Inputs) -> Result<Fitted, FitFailure> {
    let observed = observed(&inputs.logs, &inputs.read)?;
    let names = told_apart(&inputs.logs);
    let (left, mut doubts) = left_out(&names, &observed);
    let stay: Vec<usize> = (0..observed.len()).filter(|k| !left.contains_key(k)).collect();
    let (own, runs): (Vec<String>, Vec<&Recording>) =
        stay.iter().map(|k| (names[*k].clone(), &observed[*k])).unzip();
    let mut fitted = of(&own, &runs)?;
    fitted.again.iter_mut().for_each(|place| *place = stay[*place]);
    doubts.extend(std::mem::take(&mut fitted.remarks));
    Ok(Fitted { remarks: doubts, ..fitted })
}

/// The runs of which nothing is learnt, where there are others, and what is said of them.
fn left_out(names: &[String], observed: &[Recording]) -> (LeftOut, Remarks) {
    let (mut left, mut doubts) = (stopped(observed), Remarks::default());
    if left.len() == observed.len() {
        for (place, (code, why)) in std::mem::take(&mut left) {
            let message = format!("{}: {why}; what the stop did is taken for the machine's", names[place]);
            doubts.add(code, 1, message);
        }
    }
    twice(observed, names, &mut left);
    let stay: Vec<usize> = (0..observed.len()).filter(|k| !left.contains_key(k)).collect();
    let sides: Vec<[&Series; 2]> =
        stay.iter().map(|k| [&observed[*k].planned, &observed[*k].measured]).collect();
    left.extend(dead(&sides).into_iter().map(|(place, why)| (stay[place], why)));
    for (place, (code, why)) in &left {
        doubts.add(*code, 1, format!("{}: {why}; nothing is learnt from this run", names[*place]));
    }
    (left, doubts)
}

/// Reads runs.
///
/// # Errors
///
/// [`ObserveFailure`] naming the log.
pub fn observed(logs: &[PathBuf], read: &ReadOptions) -> Result<Vec<Recording>, ObserveFailure> {
    logs.iter().map(|path| observe::observe(vec![path.clone().into()], read)).collect()
}

/// Fits runs that were read from logs of these names.
///
/// # Errors
///
/// [`FitError`] if no joint can be fitted.
pub fn of(logs: &[String], observed: &[impl Borrow<Recording>]) -> Result<Fitted, FitError> {
    let observed: Vec<&Recording> = observed.iter().map(Borrow::borrow).collect();
    let observed = observed.as_slice();
    of_one_arm(logs, observed)?;
    let observations: Vec<Observation<'_>> = observed.iter().map(|run| observation(run)).collect();
    let (mut fit, held_out) =
        fit_and_held_out(&observations).map_err(|error| unsent(error, logs, observed))?;
    fit.supply = supply_of(observed, None);
    for joint in &fit.joints {
        ::log::info!(
            "{} fitted to {} samples in {} runs; {:e} rad unexplained, held-out R2 {:.3}",
            joint.name,
            joint.samples,
            joint.runs,
            joint.residual_rad,
            joint.held_out_r2
        );
    }
    let mut remarks = doubts(logs, observed);
    let mut runs = Vec::new();
    for (log, observed) in logs.iter().zip(observed) {
        runs.push(FittedRun {
            log: log.clone(),
            source: observed.source.clone(),
            commanded: observed.command.is_some(),
            valves: observed.has(SignalRole::Valve),
            identifies: Carried::identifies(observed),
        });
    }
    for joint in fit.joints.iter().filter(|joint| !joint.trusted()) {
        let message = format!(
            "{} is predicted with a held-out R2 of {:.2}, less than {}: no command is made of its model alone",
            joint.name,
            joint.held_out_r2,
            crate::fit::LEAST_SKILL
        );
        remarks.add(Code::PoorFit, 1, message);
    }
    let torques =
        observed.iter().map(|run| torques(run)).find(|torques| !torques.is_empty()).unwrap_or_default();
    let sound = |one: &Recording| !one.remarks.as_slice().iter().any(|remark| remark.code.spoils_runs());
    let carried: Vec<Carried> = observed.iter().map(|run| Carried::of(run)).collect();
    let rules = Rules::default();
    let astray = |one: &Recording| {
        let run = observation(one);
        half_astray(&fit, &one.planned, Trial { sent: run.sent, measured: run.measured })
    };
    let why_not = |k: usize| {
        match observed[k] {
        _ if runs[k].identifies => Some("it is an identification run".to_owned()),
        one if !sound(one) => Some("it does not belong to its plan, as the remarks say".to_owned()),
        one if uncorrectable(one, &rules).is_some() => Some("its plan steps".to_owned()),
        one if astray(one) => Some(
            "half of its joints or more do not follow their plan: the error of each is more than half of its motion".to_owned(),
        ),
        one => carried[k].broken(one).map(|broken| format!("its plan {broken}")),
    }
    };
    let mut not_again: Vec<Option<String>> = (0..observed.len()).map(why_not).collect();
    let again: Vec<usize> = (0..observed.len()).filter(|k| not_again[*k].is_none()).collect();
    let last = logs.last().zip(not_again.pop().flatten()).filter(|_| again.is_empty());
    let not_again = last.map(|(log, why)| format!("{log}: {why}"));
    let with_task = again.iter().rfind(|k| carried[**k].task().is_some());
    let newest = with_task.or(again.last()).copied();
    let of_plan = |k: &usize| {
        let same = |newest: usize| is_again(&observed[*k].planned, &observed[newest].planned);
        newest.is_some_and(|newest| *k == newest || *k < newest && same(newest))
    };
    let again: Vec<usize> = again.into_iter().filter(of_plan).collect();
    let corrected = again.iter().any(|k| is_corrected(observed[*k]));
    Ok(Fitted { fit, held_out, torques, runs, again, corrected, not_again, remarks })
}

impl Fitted {
    /// How many of the lags, dead bands, gains and feed-forwards of all joints are known, and of how many.
    pub fn known(&self) -> [usize; 2] {
        let of = |joint: &JointFit| {
            let numbers = [joint.lag_s, joint.dead_band_rad_s, joint.position_gain_1_s, joint.feed_forward];
            numbers.iter().filter(|number| joint.model_holds && number.identified).count()
        };
        [self.fit.joints.iter().map(of).sum(), 4 * self.fit.joints.len()]
    }
}

/// Whether something else than the plan was sent.
fn is_corrected(run: &Recording) -> bool {
    let leaves = |track: &Track| {
        let off = |planned: &Track, (t_s, sent): (&f64, &f64)| (sent - planned.held_at(*t_s).position).abs();
        let mut sent = track.t_s().iter().zip(track.position());
        run.planned.track(track.name()).is_some_and(|plan| sent.any(|sent| off(plan, sent) > SAME_RAD))
    };
    run.command.iter().flat_map(|command| &command.series.tracks).any(leaves)
}

/// Names the command that stands, where that is why nothing can be fitted.
fn unsent(error: FitError, logs: &[String], observed: &[&Recording]) -> FitError {
    let FitError::NothingMoves { least_travel_rad, .. } = error else { return error };
    let moves = |series: &Series| {
        series.tracks.iter().any(|track| {
            let [lowest, highest] = range(track.position().iter().copied());
            highest - lowest >= least_travel_rad
        })
    };
    let stands = |(log, run): (&String, &&Recording)| {
        let command =
            run.command.as_ref().filter(|command| !moves(&command.series) && moves(&run.planned))?;
        let (plan, command) = (run.source.planned_topic.clone(), command.topic.clone());
        Some(FitError::CommandStands { log: log.clone(), plan, command })
    };
    logs.iter().zip(observed).find_map(stands).unwrap_or(error)
}

/// What is doubtful in the logs, each named if there are several.
pub(super) fn doubts(logs: &[String], observed: &[&Recording]) -> Remarks {
    let mut remarks = Remarks::default();
    for (log, observed) in logs.iter().zip(observed) {
        // A machine is fitted to what was sent, whatever was planned.
        let mut own = observed.remarks.clone().without(Code::PlanIsCommand);
        doubt_leads(observed, &mut own);
        doubt_unsent(observed, &mut own);
        for remark in own.as_slice() {
            let message = &remark.message;
            let message = if logs.len() > 1 { format!("{log}: {message}") } else { message.clone() };
            remarks.add(remark.code, remark.count, message);
        }
    }
    remarks
}

/// Joints whose command the log lacks while it has that of others.
fn doubt_unsent(observed: &Recording, remarks: &mut Remarks) {
    let Some(command) = &observed.command else { return };
    let unsent = observed.measured.tracks.iter().filter(|track| command.series.track(track.name()).is_none());
    let unsent: Vec<&str> = unsent.map(Track::name).collect();
    if !unsent.is_empty() {
        let message = format!(
            "joints whose command is not in the log, where others have one: {}; nothing is learnt of them, and nothing corrected, until \
             it is logged (or named with --command)",
            unsent.join(", ")
        );
        remarks.add(Code::UnpairedJoint, unsent.len() as u64, message);
    }
}

/// Every log must share a joint with those before it: a machine is fitted, not several.
fn of_one_arm(logs: &[String], observed: &[&Recording]) -> Result<(), FitError> {
    let mut known: Vec<&Track> = Vec::new();
    for (log, observed) in logs.iter().zip(observed) {
        let own = &observed.measured.tracks;
        let same = |a: &&Track| known.iter().find(|b| b.name() == a.name()).copied();
        if !known.is_empty() && !own.iter().any(|track| same(&track).is_some()) {
            let names =
                |tracks: &[&Track]| tracks.iter().map(|track| track.name()).collect::<Vec<_>>().join(", ");
            let (found, known) = (names(&own.iter().collect::<Vec<_>>()), names(&known));
            return Err(FitError::OtherArm { log: log.clone(), found, known });
        }
        if let Some(track) = own.iter().find(|a| same(a).is_some_and(|b| a.kind() != b.kind())) {
            return Err(FitError::OtherKind { log: log.clone(), joint: track.name().to_owned() });
        }
        let new: Vec<&Track> = own.iter().filter(|track| same(track).is_none()).collect();
        known.extend(new);
    }
    Ok(())
}
