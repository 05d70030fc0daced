//! Whether a plan is one that a command can be corrected for.

use super::carried::Carried;
use crate::{
    log::Recording,
    replay::{Rules, planned_step},
};

/// A step that differs by less from a full turn is one, rad.
const TURN_RAD: f64 = 0.1;

/// Why no command is corrected for a plan.
#[derive(Debug, Clone, PartialEq)]
pub enum Uncorrectable {
    /// Its strokes show what a machine cannot follow.
    Identifies,
    /// It goes from one end of a turn to the other.
    Wraps {
        /// The joint.
        joint: String,
        /// When, s.
        at_s: f64,
    },
    /// It steps, which no joint follows.
    Steps {
        /// The joint.
        joint: String,
        /// By how much, in words.
        size: String,
        /// When, s.
        at_s: f64,
    },
}

/// Why no command is corrected for the plan of a run, if so.
pub(super) fn uncorrectable(run: &Recording, rules: &Rules) -> Option<Uncorrectable> {
    if Carried::identifies(run) {
        return Some(Uncorrectable::Identifies);
    }
    let (track, (at_s, size)) =
        run.planned.tracks.iter().find_map(|track| Some((track, planned_step(track, rules)?)))?;
    let joint = track.name().to_owned();
    if track.turns() && (size.abs() - std::f64::consts::TAU).abs() < TURN_RAD {
        return Some(Uncorrectable::Wraps { joint, at_s });
    }
    Some(Uncorrectable::Steps { joint, size: track.kind().says(size), at_s })
}
