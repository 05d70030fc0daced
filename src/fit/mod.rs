//! The response of the machine to its commands: a small model of every joint's closed loop, fitted to logs. Parameters
//! that the logs cannot identify are marked, not guessed.
//!
//! [`fit`] takes sent and measured angles and yields a [`Model`] a joint, with intervals and with its
//! skill on held-out data. [`predict`] answers a command with what the machine will do;
//! [`learn`] turns a plan and its runs into a correction that makes the next run better; [`excite`] makes a
//! run from which a fit can tell the limits.
//!
//! A joint that slides is modelled as one that turns on a lever of a metre: a radian of its numbers stands for a metre.
//!
//! Smooth runs never reach the limits of speed and acceleration, which then are bounds and no
//! numbers. Discrepancies were found on simulated machines, and no hardware was at hand.

mod beyond;
mod censor;
mod edge;
mod error;
mod estimate;
mod estimated;
mod excite;
mod excited;
mod feed_forward;
mod held_out;
mod integral;
mod interval;
mod joint;
mod kept;
mod learn;
mod model;
mod normal;
mod outcome;
mod parameters;
mod play;
mod predict;
mod robust;
mod run;
mod set_values;
mod shared;
mod simulate;
mod skill;
mod start_error;
mod structure;
mod supply;
mod swing;
mod telling;
mod valve;
mod zero;

pub use error::FitError;
pub use estimated::Estimated;
pub use excite::{Excitation, JointRoom, RAMP_S, Ramp, STROKE_POINTS_HZ, excite};
pub use excited::is_excitation;
pub use held_out::HeldOut;
pub use learn::{
    AFTER_S, Chance, Character, JointStep, Learning, Learnt, MORE_ERROR, Oscillation, Room, SHARE, Stalled,
    Step, Stop, TRAVELS_RAD, Trial, half_astray, learn,
};
pub use model::{Model, STEP_S};
pub use outcome::{
    Fit, JointFit, LEAST_SHARP_SKILL, LEAST_SKILL, LEAST_SMOOTH_SKILL, LeftOut, MOST_UNEXPLAINED,
};
pub use predict::predict;
pub use run::{Observation, SPARSEST_S};
pub use shared::{SharedJoint, SharedLimit};
pub use skill::{MOST_MARGIN, STARTS as MARGIN_STARTS};
pub use start_error::{PredictedStart, StartErrorPredictor};
pub use supply::{Fed, Supply, supply};

use crate::{
    series::{JointKind, Track},
    threads,
    units::DEGREE_RAD,
};
use run::{Run, runs, sparse_s};

/// A joint that is sent less far than this cannot be fitted, rad.
const LEAST_TRAVEL_RAD: f64 = 0.5 * DEGREE_RAD;

/// Fits every joint that is sent and measured in any of the logs, all logs of it at once.
///
/// Deterministic, whatever the number of threads.
///
/// # Errors
///
/// [`FitError::NothingMoves`] if no joint can be fitted.
pub fn fit(logs: &[Observation]) -> Result<Fit, FitError> {
    fit_and_held_out(logs).map(|(fit, _)| fit)
}

impl Fit {
    /// The same, with what its models leave unexplained in these runs weighed against what is known: `left` gets what was held out
    /// of the fit, if anything, and what is found here, mean and 0.9 quantile of peaks, rad. A speed limit that a joint is beyond in them
    /// is none.
    pub fn held_against(
        mut self,
        logs: &[Observation],
        left: impl Fn(Option<[f64; 2]>, [f64; 2]) -> [f64; 2],
    ) -> Self {
        let mut workspace = estimate::Workspace::default();
        for joint in &mut self.joints {
            let of_log = |log: &Observation| {
                Some(runs(log.sent.track(&joint.name)?, log.measured.track(&joint.name)?))
            };
            let runs: Vec<Run> = logs.iter().filter_map(of_log).flatten().collect();
            // A joint that stood elsewhere left all of its way there, which says nothing of these runs.
            let fewest = if joint.trusted() { skill::FEWEST } else { 1 };
            let found = skill::unexplained_by(&joint.model, &runs, fewest, &mut workspace);
            let known = joint.unexplained_peak_rad;
            joint.unexplained_peak_rad = found.map(|found| left(known, found)).or(known);
            for (way, sign) in [1.0, -1.0].into_iter().enumerate() {
                joint.has_reached(way, kept::kept_rad_s(&runs, sign, run::REACHED_OVER_S, 2));
            }
        }
        self
    }
}

/// The logs, that with the largest error first and equals by what they hold, each with its place among those given: what is found must not
/// depend on that.
fn ordered<'a>(logs: &[Observation<'a>]) -> (Vec<usize>, Vec<Observation<'a>>) {
    fn held<'b>(log: &'b Observation) -> impl Iterator<Item = u64> + use<'b> {
        let tracks = log.measured.tracks.iter().chain(&log.sent.tracks);
        tracks.flat_map(|track| track.position().iter().map(|value| value.to_bits()))
    }
    let off = |log: &Observation| -> f64 {
        let of = |came: &Track| {
            let (sent, mut cursor) = (log.sent.track(came.name())?, 0);
            let squares = came.t_s().iter().zip(came.position());
            let mean = squares
                .map(|(t_s, q)| (q - sent.held_after(&mut cursor, *t_s).position).powi(2))
                .sum::<f64>()
                / came.len().max(1) as f64;
            Some(mean)
        };
        log.measured.tracks.iter().filter_map(of).sum()
    };
    let mut logs: Vec<(usize, Observation<'a>, f64)> =
        logs.iter().enumerate().map(|(place, log)| (place, *log, off(log))).collect();
    logs.sort_by(|(_, a, a_off), (_, b, b_off)| b_off.total_cmp(a_off).then_with(|| held(a).cmp(held(b))));
    logs.into_iter().map(|(place, log, _)| (place, log)).unzip()
}

/// The same, with prediction beside measurement where it was held out of the fit: 450 s of each joint's motion at most.
///
/// # Errors
///
/// As [`fit`].
pub fn fit_and_held_out(logs: &[Observation]) -> Result<(Fit, Vec<HeldOut>), FitError> {
    let mut names: Vec<(&str, JointKind)> = Vec::new();
    for log in logs {
        for track in &log.sent.tracks {
            let (name, kind) = (track.name(), track.kind());
            if log.measured.track(name).is_some() && names.iter().all(|(other, _)| *other != name) {
                names.push((name, kind));
            }
        }
    }
    let (given, logs) = ordered(logs);
    let of = |(name, kind): &(&str, JointKind)| -> Vec<Run> {
        let of_log = |(log, seen): (&usize, &Observation)| {
            let both = [seen.sent.track(name)?, seen.measured.track(name)?];
            let runs = both.iter().all(|track| track.kind() == *kind).then(|| runs(both[0], both[1]))?;
            let log = *log;
            Some(runs.into_iter().map(move |run| Run { log, ..run }))
        };
        given.iter().zip(&logs).filter_map(of_log).flatten().collect()
    };
    let fitted = threads::mapped(
        &names,
        || (),
        |(), joint| {
            let (runs, (name, kind)) = (of(joint), *joint);
            let travel_rad: f64 = runs.iter().map(Run::travel_rad).sum();
            let moves = travel_rad >= LEAST_TRAVEL_RAD;
            let left_out =
                LeftOut { name: name.to_owned(), kind, travel_rad, least_travel_rad: LEAST_TRAVEL_RAD };
            moves
                .then(|| {
                    let (mut joint, ratios, mut held_out) = joint::joint((name, kind), &runs);
                    held_out.sort_by_key(|stretch| stretch.log);
                    let signals = logs.iter().filter_map(|log| {
                        let valve = log.valve.iter().find(|signal| signal.name() == name)?;
                        Some((valve, log.measured.track(name)?))
                    });
                    joint.valve_dead_band = valve::dead_band(&signals.collect::<Vec<_>>());
                    (joint, ratios, held_out)
                })
                .ok_or(left_out)
        },
    );
    let (mut joints, mut ratios, mut left_out) = (Vec::new(), Vec::new(), Vec::new());
    let mut held_out = Vec::new();
    for found in fitted {
        match found {
            Ok((joint, of_joint, stretches)) => {
                joints.push(joint);
                ratios.extend(of_joint);
                held_out.extend(stretches);
            }
            Err(joint) => left_out.push(joint),
        }
    }
    if joints.is_empty() {
        let least_travel_rad = LEAST_TRAVEL_RAD;
        let sparse_s = |log: &Observation, name: &str| {
            sparse_s(log.sent.track(name)?, log.measured.track(name)?, least_travel_rad)
        };
        let all_s = logs.iter().flat_map(|log| names.iter().filter_map(move |(name, _)| sparse_s(log, name)));
        if let Some(interval_s) = all_s.reduce(f64::min) {
            return Err(FitError::TooSparse { interval_s, most_s: SPARSEST_S });
        }
        return Err(FitError::NothingMoves { logs: logs.len(), shared: names.len(), least_travel_rad });
    }
    let named: Vec<(String, JointKind)> =
        joints.iter().map(|joint| (joint.name.clone(), joint.kind)).collect();
    let shared = shared::shared(&named, &logs);
    for sharing in shared.iter().flat_map(|shared| &shared.joints) {
        for joint in joints.iter_mut().filter(|joint| joint.name == sharing.name) {
            joint.makes_alone(sharing.alone_rad_s);
        }
    }
    let (margin_starts, peak_margin) = (ratios.len(), skill::margin(ratios));
    Ok((Fit { joints, left_out, margin_starts, peak_margin, shared, supply: None }, held_out))
}
