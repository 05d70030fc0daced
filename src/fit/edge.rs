//! Whether the edges of a valve open gradually: speed then grows by more than what is asked.

use super::{
    estimate::{Estimate, Problem, Workspace},
    parameters::EDGE,
};
use crate::units::DEGREE_RAD;

/// The cost, a logarithm of likelihood, must fall by this: on machines whose speed grows in proportion an edge gains by
/// chance and by other parts of their structure.
const GAIN: f64 = 12.0;

/// A shorter edge is friction and play by another name, rad/s.
const SHORTEST_RAD_S: f64 = 0.8 * DEGREE_RAD;

/// Rounds of the descent with an edge.
const ROUNDS: usize = 20;

/// The estimate with an edge, if the data show one.
pub(super) fn edge(problem: &Problem, found: &Estimate, workspace: &mut Workspace) -> Option<Estimate> {
    let mut edged = problem.clone();
    edged.shown.valve.edge = true;
    let before = problem.cost_at(&found.x, found.scale_rad, workspace);
    let with = edged.descend(found.x.clone(), ROUNDS, workspace);
    let gained = before - edged.cost_at(&with.x, found.scale_rad, workspace);
    let edge_rad_s = problem.priors.of(EDGE).value(with.x[EDGE]);
    (gained > GAIN && edge_rad_s > SHORTEST_RAD_S).then_some(with)
}
