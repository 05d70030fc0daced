//! Whether the position loop integrates: over long rests an integral that is not there is held off by a dead band that is
//! not there either.

use super::{
    estimate::{Estimate, Problem, Workspace},
    parameters::{DEAD_BAND, INTEGRAL_GAIN},
};

/// Rounds of the descent without an integral.
const ROUNDS: usize = 20;

/// The estimate without an integral, if it costs less: then the data do not show one.
pub(super) fn without(problem: &Problem, found: &Estimate, workspace: &mut Workspace) -> Option<Estimate> {
    let mut other = problem.clone();
    other.shown.integral = false;
    let before = problem.cost_at(&found.x, found.scale_rad, workspace);
    let mut x = found.x.clone();
    // The dead band starts anew: it has held the integral off.
    x[INTEGRAL_GAIN] = 0.0;
    x[DEAD_BAND] = 0.0;
    let without = other.descend(x, ROUNDS, workspace);
    (other.cost_at(&without.x, found.scale_rad, workspace) < before).then_some(without)
}
