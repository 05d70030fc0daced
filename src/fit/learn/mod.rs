//! The next correction of a plan, from the runs that were made of it: first by model and data together, then by
//! the measured error, run after run (iterative learning control, Arimoto et al. 1984, doi:10.1002/rob.4620010203).

mod answer;
mod astray;
mod chance;
mod correct;
mod joint;
mod oscillation;
mod part;
mod shape;
mod spoilt;
mod spread;
mod stalled;
mod stop;

use std::ops::Range;

pub use answer::AFTER_S;
pub use astray::{TRAVELS_RAD, half_astray};
pub use chance::Chance;
pub use oscillation::{Character, Oscillation};
pub use shape::{Room, SHARE};
pub use spoilt::MORE_ERROR;
pub use stalled::Stalled;
pub use stop::Stop;

use super::{
    Fit, FitError,
    model::{STEP_S, steps_in},
    run::MOVES_RAD_S,
};
use serde::{Deserialize, Serialize};

use crate::series::{JointKind, Series, SignalError, Track};
use joint::Joint;

/// Rest before a motion in which its correction begins, s.
const OPENS_S: f64 = 1.3;

/// Rest after a motion in which its correction ends, s.
const CLOSES_S: f64 = 1.8;

/// Joints that hunt from which on nothing is corrected: a correction may throw such a loop into a larger oscillation.
const MOST_HUNTING: usize = 3;

/// How far a command may leave its plan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Learning {
    /// Share of each correction that is applied, 0 to 1: less while a machine is new.
    pub gain: f64,
    /// Largest distance of command and plan of a joint that turns, rad; by the largest error without one.
    pub most_rad: Option<f64>,
    /// The same of a joint that slides, m.
    pub most_m: Option<f64>,
    /// The run whose correction is to be kept.
    pub keep: Option<usize>,
    /// Whether the only run is the first of a machine that has changed: its correction was made for another one, and the next
    /// is a first one again.
    pub anew: bool,
    /// Whether the machine goes on changing one way: corrections go on from the newest run, whatever was better before.
    pub follow: bool,
}

impl Default for Learning {
    fn default() -> Self {
        Self { gain: 1.0, most_rad: None, most_m: None, keep: None, anew: false, follow: false }
    }
}

/// A run of the plan: what was sent and what came, on the clock of the plan.
#[derive(Debug, Clone, Copy)]
pub struct Trial<'a> {
    /// Sent angles.
    pub sent: &'a Series,
    /// Measured angles.
    pub measured: &'a Series,
}

/// How a correction came about.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(tag = "by", rename_all = "snake_case")]
pub enum Step {
    /// By the model alone: no run of this plan is known.
    Model,
    /// The first one, by model and data.
    First {
        /// Weight of the model, 0 to 1.
        model_weight: f64,
    },
    /// The correction of a run (by index), and a share of its error.
    Later {
        /// The run that it goes on from.
        from: usize,
        /// Share of the error.
        gain: f64,
    },
    /// The correction of a run (by index), which was a part of the first one, and a share of what is left of that.
    Rest {
        /// The run that it goes on from.
        from: usize,
        /// Share of the rest.
        share: f64,
    },
    /// The correction of a run (by index) once more: there is nothing more to gain.
    Kept {
        /// The run.
        from: usize,
        /// The run (by index) whose smaller correction is taken in a motion in which it left less error.
        #[serde(default)]
        but: Option<usize>,
    },
    /// None: the joint does not follow its plan; its error is more than half of its motion.
    Astray,
    /// None: the joint is not known, not predicted, or not to be touched.
    None,
}

/// The next correction of one joint.
#[derive(Debug, Clone, PartialEq)]
pub struct JointStep {
    /// The joint.
    pub name: String,
    /// How it came about.
    pub step: Step,
    /// Periodicity of what the model leaves unexplained; `None` without a run of this plan.
    pub oscillation: Option<Oscillation>,
    /// Root mean square error of each run below 1.5 Hz, rad.
    pub rms_error_rad: Vec<f64>,
    /// Root mean square difference that the model does not explain of the last run and one before it, one in which the same
    /// was sent if there is one, below 1.5 Hz, by the root of two: what comes differently each time; `None` with fewer than two runs.
    pub spread_rad: Option<f64>,
    /// Largest correction that was allowed, rad.
    pub most_rad: f64,
    /// Frequency above which nothing is learnt, Hz.
    pub cut_off_hz: f64,
    /// For how long the plan moves and the newest run was not measured, s: nothing is learnt there.
    pub unseen_s: f64,
    /// What the newest run was off by at rest, before its first motion and after its last alike, rad: that is a zero, or a load,
    /// and is not learnt; zero where the rests differ.
    pub shifted_rad: f64,
    /// Where a larger correction gained nothing: the smaller one is taken again there.
    pub stalled: Vec<Stalled>,
    /// Where something holds it, whatever is sent.
    pub stop: Option<Stop>,
    /// What came by chance in the newest run, and is not learnt.
    pub chance: Option<Chance>,
    /// Correction, rad, its speed, rad/s, and acceleration, rad/s², every [`STEP_S`] from the plan's first sample.
    pub correction: Vec<[f64; 3]>,
}

/// The next correction.
#[derive(Debug, Clone, PartialEq)]
pub struct Learnt {
    /// One entry a joint of the plan.
    pub joints: Vec<JointStep>,
    /// Joints that hunt: with three or more nothing is corrected.
    pub hunting: usize,
}

impl Learnt {
    /// The plan with the corrections times `share`, joint by joint.
    ///
    /// # Errors
    ///
    /// [`SignalError`] for another plan than the corrections were made for.
    pub fn command(&self, plan: &Series, share: impl Fn(&str) -> f64) -> Result<Series, SignalError> {
        let one = |track: &Track| {
            let Some(joint) = self.joints.iter().find(|joint| joint.name == track.name()) else {
                return Ok(track.clone());
            };
            let from_s = track.t_s().first().copied().unwrap_or_default();
            let t_s: Vec<f64> = (0..joint.correction.len()).map(|k| from_s + k as f64 * STEP_S).collect();
            let planned = super::run::sampled(track, from_s, t_s.len());
            let by = share(track.name());
            let states = || planned.iter().zip(&joint.correction);
            let position_rad = states().map(|(planned, made)| planned.0 + by * made[0]).collect();
            let velocity_rad_s = states().map(|(planned, made)| planned.1 + by * made[1]).collect();
            Track::of(track.kind(), track.name(), t_s, position_rad, &[])?.with_velocity(velocity_rad_s)
        };
        Ok(Series { tracks: plan.tracks.iter().map(one).collect::<Result<_, _>>()? })
    }
}

/// The next correction of a plan.
///
/// `plan` rests at its ends, for 1.3 s before and 1.8 s after its motion at least, and has speeds; `runs` are runs of it, in their order;
/// `room` says what a joint may do, if that is known.
///
/// # Errors
///
/// [`FitError::Setting`], [`FitError::Value`] for an impossible model, [`FitError::Duration`] for a plan longer than an
/// hour.
pub fn learn(
    fit: &Fit,
    plan: &Series,
    runs: &[Trial],
    settings: Learning,
    room: impl Fn(&str) -> Option<Room>,
) -> Result<Learnt, FitError> {
    settings.check()?;
    fit.check()?;
    let mut joints = Vec::with_capacity(plan.tracks.len());
    for track in &plan.tracks {
        joints.push(Joint::of(fit.joint(track.name()), track, runs)?);
    }
    let free = free(&joints);
    let known = joints.iter().filter(|joint| joint.oscillation.is_some()).count();
    let is = |joint: &Joint, of: Character| joint.oscillation.is_some_and(|found| found.character == of);
    let hunting = joints.iter().filter(|joint| is(joint, Character::Hunts)).count();
    let flagged = hunting + joints.iter().filter(|joint| is(joint, Character::Rings)).count();
    let all_ring = flagged > 0 && 2 * flagged >= known;
    let untouched = hunting >= MOST_HUNTING;
    let joints =
        joints.into_iter().map(|joint| joint.next(settings, all_ring, untouched, &free, &room)).collect();
    Ok(Learnt { joints, hunting })
}

impl Learning {
    /// Of a joint of a kind; of one that slides a radian stands for a metre.
    fn most(&self, kind: JointKind) -> Option<f64> {
        if kind == JointKind::Slides { self.most_m } else { self.most_rad }
    }

    fn check(&self) -> Result<(), FitError> {
        let [most_rad, most_m] = [self.most_rad, self.most_m].map(Option::unwrap_or_default);
        let all = [("gain", self.gain), ("most_rad", most_rad), ("most_m", most_m)];
        for (key, found) in all {
            if !(0.0..=1.0).contains(&found) {
                return Err(FitError::Setting { key, found, least: 0.0, most: 1.0 });
            }
        }
        Ok(())
    }
}

/// Stretches in which corrections may differ from zero: motions of the arm with the rest that opens and closes them.
fn free(joints: &[Joint]) -> Vec<Range<usize>> {
    let (opens, closes) = (steps_in(OPENS_S), steps_in(CLOSES_S));
    let mut free: Vec<Range<usize>> = Vec::new();
    let steps = joints.iter().map(|joint| joint.planned.len()).max().unwrap_or_default();
    let moves = |k: &usize| {
        joints.iter().any(|joint| joint.planned.get(*k).is_some_and(|planned| planned.1.abs() > MOVES_RAD_S))
    };
    for k in (0..steps).filter(moves) {
        let end = (k + 1 + closes).min(steps);
        match free.last_mut() {
            Some(last) if last.end + opens >= k => last.end = end,
            _ => free.push(k.saturating_sub(opens)..end),
        }
    }
    free
}
