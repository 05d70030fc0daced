//! Limits of torques, rods, flow and tool, and power, linearised: what the joints make together.

use super::{
    aim::Aim,
    curve::Frame,
    model::{Model, Part},
    point::Point,
    response::{Response, STATE},
    row::Row,
};
use crate::spline::Place;

/// Loads below this share of a limit do not bound a step.
const NEAR: f64 = 0.6;

/// Numbers of limits from here on are those of loads.
pub(super) const LOADS: usize = usize::MAX / 2;

impl Model {
    /// Adds the loads that are near their limits, and power where it counts.
    pub(super) fn loads(&mut self, frame: &Frame<'_>, here: &Point, aim: &Aim) {
        let (powers, mesh) = (aim.counts_power(&here.objectives), &here.mesh);
        if !powers && mesh.shares.iter().all(|share| aim.guard * share < NEAR) {
            return;
        }
        self.unknowns.joined = true;
        let (response, joints) = (Response::of(frame.setup, mesh), frame.joints());
        for (index, segment) in here.motion.segments().iter().enumerate() {
            let part = Part { segment, index, interval_s: &here.curve.interval_s };
            let (spline, range) = (&segment.spline, mesh.segment[index].clone());
            let nodes = (range.len() / spline.pieces()).max(1);
            let breaks_s = &spline.knots_s()[spline.degree().order()..];
            for (i, instant) in range.enumerate() {
                let piece = i / nodes;
                let length_s = breaks_s[piece + 1] - breaks_s[piece];
                let share = (mesh.t_s[instant] - segment.start_s - breaks_s[piece]) / length_s;
                let weights = spline.weights(Place::Piece(piece, share));
                let state: Vec<Row> = (0..joints)
                    .flat_map(|joint| (0..STATE.len()).map(move |order| (joint, order)))
                    .map(|(joint, order)| part.row(&weights, order, joint))
                    .collect();
                let of = |row: usize| {
                    let slope =
                        |at: usize| response.slope(row, instant, (at / STATE.len(), at % STATE.len()));
                    Row::joined(&state, STATE.len(), slope, response.value(row, instant))
                };
                for row in 0..response.limits() {
                    if aim.guard * response.value(row, instant) > NEAR {
                        let number = LOADS + (segment.first_point + piece) * response.limits() + row;
                        self.shares.push((number, of(row).scaled(aim.guard)));
                    }
                }
                if powers {
                    let weight_s = mesh.weights_s[instant];
                    for joint in 0..joints {
                        let row = part.with_length(of(response.limits() + joint), piece, length_s);
                        self.power.push((joint, row.scaled(weight_s.sqrt())));
                    }
                }
            }
        }
    }
}
