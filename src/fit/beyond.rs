//! Whether a valve opens beyond what the largest speeds of its joint take, as where the flow is limited behind it: it then takes time
//! to come back, and a joint at its limit answers late.

use super::{
    estimate::{Estimate, Problem, Workspace},
    parameters::{BEYOND, Shown},
};

/// The cost, a logarithm of likelihood, must fall by this.
const GAIN: f64 = 12.0;

/// A smaller share is none.
const LEAST: f64 = 0.1;

/// Rounds of the descent with such a valve.
const ROUNDS: usize = 38;

/// The estimate with such a valve, if the data show one.
pub(super) fn beyond(
    problem: &Problem,
    found: &Estimate,
    workspace: &mut Workspace,
) -> Option<(Estimate, Shown)> {
    if problem.shown.valve.beyond || problem.shown.limits[..2] == [false; 2] {
        return None;
    }
    let mut opened = problem.clone();
    opened.shown.valve.beyond = true;
    let with = opened.descend(found.x.clone(), ROUNDS, workspace);
    let share = problem.priors.of(BEYOND).value(with.x[BEYOND]);
    (share > LEAST && problem.gains(GAIN, &opened, &with, found, workspace)).then_some((with, opened.shown))
}
