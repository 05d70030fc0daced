//! Proportional iterative learning, as textbooks give it: the last command and a share of the error, earlier by the lag.

use hydrotrace::{
    fit::{Fit, Observation, fit},
    math::lowpass,
    series::{Series, Track},
};

use super::{LearningError, Ran};

const GAIN: f64 = 0.9;
const CUT_OFF_HZ: f64 = 0.5;
const STEP_S: f64 = 0.01;

/// The next command from all runs so far, of which the first was that of the plan.
pub(super) fn next(runs: &[Ran]) -> Result<Series, LearningError> {
    let observed: Vec<Observation> = (runs.iter().take(1))
        .map(|run| Observation { sent: &run.sent, measured: &run.measured, valve: &[] })
        .collect();
    let fit = fit(&observed)?;
    let Some(first) = runs.first() else { return Ok(Series::default()) };
    let tracks = first.plan.tracks.iter().map(|track| {
        let (t_s, position, speed) = corrected(track, &fit, runs);
        Track::new(track.name(), t_s, position, &[])?.with_velocity(speed)
    });
    Ok(Series { tracks: tracks.collect::<Result<_, _>>()? })
}

/// Instants, angles and speeds of one joint's command.
fn corrected(track: &Track, fit: &Fit, runs: &[Ran]) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
    let end_s = track.t_s().last().copied().unwrap_or_default();
    let mut t_s = vec![0.0];
    while let Some(last) = t_s.last().filter(|last| **last < end_s) {
        t_s.push(last + STEP_S);
    }
    let mut correction = vec![0.0; t_s.len()];
    let ahead_s = fit.joint(track.name()).map_or(0.0, |joint| joint.model.lag_s());
    for measured in runs.iter().filter_map(|run| run.measured.track(track.name())) {
        let at = |t_s: f64| track.held_at(t_s).position - measured.held_at(t_s).position;
        let mut error_rad: Vec<f64> = t_s.iter().map(|t_s| at(t_s + ahead_s)).collect();
        lowpass(&mut error_rad, CUT_OFF_HZ, STEP_S);
        correction.iter_mut().zip(error_rad).for_each(|(c, e)| *c += GAIN * e);
    }
    let position =
        t_s.iter().zip(&correction).map(|(t_s, made)| track.held_at(*t_s).position + made).collect();
    let last = correction.len() - 1;
    let slope = |k: usize| {
        let (before, after) = (k.saturating_sub(1), (k + 1).min(last));
        (correction[after] - correction[before]) / ((after - before).max(1) as f64 * STEP_S)
    };
    let speed = t_s.iter().enumerate().map(|(k, t_s)| track.held_at(*t_s).velocity + slope(k)).collect();
    (t_s, position, speed)
}
