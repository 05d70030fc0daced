//! Proportional iterative learning, as textbooks give it: the last command and a share of the error, earlier by the lag.

use hydrotrace::{
    math::lowpass,
    series::{Series, Track},
};

use super::{Job, LearningError, fitted, sent};

const GAIN: f64 = 0.9;
const CUT_OFF_HZ: f64 = 0.5;
const STEP_S: f64 = 0.01;

/// The next command from all runs so far.
pub(super) fn next(job: &Job, logs: &[(Series, Series)]) -> Result<Series, LearningError> {
    let fit = fitted(&logs[..1])?;
    let mut corrections =
        vec![vec![0.0; job.plan.tracks.first().map_or(0, Track::len)]; job.plan.tracks.len()];
    for (_, measured) in logs {
        for (track, correction) in job.plan.tracks.iter().zip(&mut corrections) {
            let (Some(joint), Some(measured)) = (fit.joint(track.name()), measured.track(track.name()))
            else {
                continue;
            };
            let ahead_s = joint.model.lag_s();
            let at = |t_s: f64| track.held_at(t_s).position - measured.held_at(t_s).position;
            let mut error_rad: Vec<f64> = track.t_s().iter().map(|t_s| at(t_s + ahead_s)).collect();
            lowpass(&mut error_rad, CUT_OFF_HZ, STEP_S);
            correction.iter_mut().zip(error_rad).for_each(|(c, e)| *c += GAIN * e);
        }
    }
    let states: Vec<Vec<[f64; 3]>> = corrections.iter().map(|correction| states(correction)).collect();
    Ok(sent(&job.plan, &states.iter().map(|states| &states[..]).collect::<Vec<_>>())?)
}

fn states(correction: &[f64]) -> Vec<[f64; 3]> {
    let last = correction.len().saturating_sub(1);
    (0..correction.len())
        .map(|k| {
            let (before, after) = (k.saturating_sub(1), (k + 1).min(last));
            let span_s = (after - before).max(1) as f64 * STEP_S;
            [correction[k], (correction[after] - correction[before]) / span_s, 0.0]
        })
        .collect()
}
