//! Whether the play between joint and sensor is another than the usual one: where the sensor sits on the joint there is none, and a dead
//! band that is not there would make up for it.

use super::{
    estimate::{Estimate, Problem, Workspace},
    parameters::{PLAY, Shown},
};
use crate::units::DEGREE_RAD;

/// The cost, a logarithm of likelihood, must fall by this.
const GAIN: f64 = 12.0;

/// Widths, rad, where descents start.
const STARTS_RAD: [f64; 2] = [0.01 * DEGREE_RAD, 0.2 * DEGREE_RAD];

/// The estimate with a play of its own, if the data show one.
pub(super) fn played(
    problem: &Problem,
    found: &Estimate,
    workspace: &mut Workspace,
) -> Option<(Estimate, Shown)> {
    if problem.shown.between.play {
        return None;
    }
    let mut other = problem.clone();
    other.shown.between.play = true;
    let starts = STARTS_RAD.map(|width_rad| {
        let mut x = found.x.clone();
        x[PLAY] = problem.priors.of(PLAY).place(width_rad);
        x
    });
    let with = other.search(starts, workspace);
    problem.gains(GAIN, &other, &with, found, workspace).then_some((with, other.shown))
}
