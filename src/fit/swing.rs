//! Whether a joint swings between valve and sensor, on its oil or its link: what it does then is behind what is asked by more the
//! faster that changes, which late set values would stand in for.

use std::ops::Range;

use super::{
    estimate::{Estimate, Problem, Workspace},
    parameters::{DAMPING, DEAD_TIME, FREQUENCY, Shown, TIME_CONSTANT},
};

/// The cost, a logarithm of likelihood, must fall by this: of models of another form a swing explains a little by chance.
const GAIN: f64 = 25.0;

/// A joint with more damping is behind, and does not swing; one with less oscillates by itself, and would be explained by any start.
const DAMPING_RATIO: Range<f64> = 0.1..0.9;

/// Share of the largest position gain with which the loop of a joint that swings is stable, 2 * damping ratio * natural frequency: one of
/// more oscillates by itself, and explains any oscillation.
const STABLE: f64 = 0.9;

/// Natural frequencies, rad/s, where descents start, with this damping, dead time and time constant, s.
const STARTS_RAD_S: [f64; 3] = [6.0, 12.0, 24.0];
const DAMPED: f64 = 0.3;
const DEAD_TIME_S: f64 = 0.06;
const TIME_CONSTANT_S: f64 = 0.03;

/// The estimate of a joint that swings, if the data show it.
pub(super) fn swinging(
    problem: &Problem,
    found: &Estimate,
    workspace: &mut Workspace,
) -> Option<(Estimate, Shown)> {
    if problem.shown.between.swing {
        return None;
    }
    let mut other = problem.clone();
    other.shown.between.swing = true;
    let place = |i: usize, value: f64| problem.priors.of(i).place(value);
    let starts = STARTS_RAD_S.map(|frequency_rad_s| {
        let mut x = found.x.clone();
        x[FREQUENCY] = place(FREQUENCY, frequency_rad_s);
        x[DAMPING] = place(DAMPING, DAMPED);
        x[DEAD_TIME] = place(DEAD_TIME, DEAD_TIME_S);
        x[TIME_CONSTANT] = place(TIME_CONSTANT, TIME_CONSTANT_S);
        x
    });
    let with = other.search(starts, workspace);
    let model = other.model(&with.x);
    let most_1_s = 2.0 * model.damping_ratio * model.natural_frequency_rad_s;
    let stable = DAMPING_RATIO.contains(&model.damping_ratio) && model.position_gain_1_s < STABLE * most_1_s;
    (stable && problem.gains(GAIN, &other, &with, found, workspace)).then_some((with, other.shown))
}
