//! Whether the position loop integrates: over long rests an integral that is not there is held off by a dead band that is
//! not there either. And whether it is held within limits, as controllers do so that it does not wind up: such a loop pushes a
//! joint that moves by as much either way, which looks like a speed that is fed forward.

use super::{
    estimate::{Estimate, Problem, Workspace},
    parameters::{DEAD_BAND, INTEGRAL_GAIN, INTEGRAL_LIMIT, Integral, Shown},
};
use crate::units::DEGREE_RAD;

/// Rounds of the descent without an integral.
const ROUNDS: usize = 20;

/// The estimate without an integral, if it costs less: then the data do not show one.
pub(super) fn without(problem: &Problem, found: &Estimate, workspace: &mut Workspace) -> Option<Estimate> {
    let mut other = problem.clone();
    other.shown.integral = Integral::None;
    let before = problem.cost_at(&found.x, found.scale_rad, workspace);
    let mut x = found.x.clone();
    // The dead band starts anew: it has held the integral off.
    x[INTEGRAL_GAIN] = 0.0;
    x[DEAD_BAND] = 0.0;
    let without = other.descend(x, ROUNDS, workspace);
    (other.cost_at(&without.x, found.scale_rad, workspace) < before).then_some(without)
}

/// The cost, a logarithm of likelihood, must fall by this for a limit.
const GAIN: f64 = 12.0;

/// Gain, 1/s², and limit of the integral, rad/s, where descents start.
const STARTS: [[f64; 2]; 2] = [[1.0, 2.0 * DEGREE_RAD], [2.5, 5.0 * DEGREE_RAD]];

/// The estimate with an integral that is held within limits, with or without a feed-forward, if the data show them.
pub(super) fn limited(
    problem: &Problem,
    found: &Estimate,
    workspace: &mut Workspace,
) -> Option<(Estimate, Shown)> {
    if problem.shown.integral == Integral::Held {
        return None;
    }
    let place = |i: usize, value: f64| problem.priors.of(i).place(value);
    let mut best: Option<(f64, Estimate, Shown)> = None;
    for feed_forward in [true, false] {
        let mut other = problem.clone();
        other.shown = Shown { integral: Integral::Held, feed_forward, ..problem.shown };
        let starts = STARTS.map(|[gain_1_s2, limit_rad_s]| {
            let mut x = found.x.clone();
            x[INTEGRAL_GAIN] = place(INTEGRAL_GAIN, gain_1_s2);
            x[INTEGRAL_LIMIT] = place(INTEGRAL_LIMIT, limit_rad_s);
            x
        });
        let with = other.search(starts, workspace);
        let cost = other.cost_at(&with.x, found.scale_rad, workspace);
        if best.as_ref().is_none_or(|(least, ..)| cost < *least)
            && problem.gains(GAIN, &other, &with, found, workspace)
        {
            best = Some((cost, with, other.shown));
        }
    }
    best.map(|(_, with, shown)| (with, shown))
}
