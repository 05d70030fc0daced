//! Whether the position loop integrates: over long rests an integral that is not there is held off by a dead band that is
//! not there either.

use super::{
    estimate::{Estimate, Problem, Workspace},
    parameters::{DEAD_BAND, INTEGRAL_GAIN},
};

/// Rounds of the descent without an integral.
const ROUNDS: usize = 20;

/// The estimate without an integral, if the data are explained no worse by one.
pub(super) fn without(problem: &Problem, found: &Estimate, workspace: &mut Workspace) -> Option<Estimate> {
    let mut other = problem.clone();
    other.shown.integral = false;
    let mut residuals = Vec::new();
    let mut cost = |problem: &Problem, x: &[f64], workspace: &mut Workspace| {
        problem.residuals(x, workspace, &mut residuals);
        problem.cost(x, &residuals, found.scale_rad)
    };
    let before = cost(problem, &found.x, workspace);
    let mut x = found.x.clone();
    x[INTEGRAL_GAIN] = 0.0;
    x[DEAD_BAND] = 0.0;
    let without = other.descend(x, ROUNDS, workspace);
    let after = cost(&other, &without.x, workspace);
    (after < before).then_some(without)
}
