//! The response of a joint to a command.

use super::{
    FitError, Model,
    model::{STEP_S, steps_in},
    run::sampled,
    simulate::{Start, simulate},
};
use crate::series::Track;

/// Longest command, s.
const LONGEST_S: f64 = 3600.0;

/// Answers a command with the predicted measured angle at the command's stamps.
///
/// The joint rests at the first angle with an empty integral; across cuts the command is held.
/// Speeds are the track's own, differences where it has none.
///
/// # Errors
///
/// [`FitError::Duration`] for a command longer than an hour, [`FitError::Value`] for an impossible model.
pub fn predict(model: &Model, sent: &Track) -> Result<Track, FitError> {
    model.check(sent.name())?;
    let grid = grid(sent)?;
    let (mut wanted, mut angle_rad) = (Vec::new(), Vec::new());
    simulate(model, &grid, Start::at_rest(model, &grid), &mut wanted, &mut angle_rad);
    let from_s = sent.t_s().first().copied().unwrap_or_default();
    let at = |t_s: &f64| {
        let step = steps_in(t_s - from_s);
        let part = (t_s - from_s) / STEP_S - step as f64;
        let here = angle_rad.get(step).copied().unwrap_or_default();
        here + part * (angle_rad.get(step + 1).copied().unwrap_or(here) - here)
    };
    let position_rad: Vec<f64> = sent.t_s().iter().map(at).collect();
    let cuts: Vec<usize> = sent.segments().iter().skip(1).map(|segment| segment.start).collect();
    let not_a_number = || FitError::Value {
        joint: sent.name().to_owned(),
        key: "predicted angle",
        found: f64::NAN,
        least: -1e4,
        most: 1e4,
    };
    Track::of(sent.kind(), sent.name(), sent.t_s(), position_rad, &cuts).map_err(|_| not_a_number())
}

/// A command on the steps of the model, one step past its end.
pub(super) fn grid(sent: &Track) -> Result<Vec<(f64, f64)>, FitError> {
    let (from_s, to_s) =
        (sent.t_s().first().copied().unwrap_or_default(), sent.t_s().last().copied().unwrap_or_default());
    let duration_s = to_s - from_s;
    if duration_s.is_nan() || duration_s > LONGEST_S {
        return Err(FitError::Duration { joint: sent.name().to_owned(), duration_s, most_s: LONGEST_S });
    }
    Ok(sampled(sent, from_s, steps_in(duration_s) + 2))
}
