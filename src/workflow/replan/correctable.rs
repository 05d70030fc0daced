//! Whether a plan is one that a command can be corrected for.

use std::path::Path;

use super::ReplanFailure;
use crate::{
    log::Recording,
    replay::{Rules, planned_step},
    workflow::carried::Carried,
};

/// A step that differs by less from a full turn is one, rad.
const TURN_RAD: f64 = 0.1;

/// No correction helps where a plan steps, and none is meant where strokes show what a machine cannot follow.
pub(super) fn correctable(path: &Path, run: &Recording, rules: &Rules) -> Result<(), ReplanFailure> {
    if Carried::identifies(run) {
        return Err(ReplanFailure::Identifies { path: path.to_owned() });
    }
    let found = run.planned.tracks.iter().find_map(|track| Some((track, planned_step(track, rules)?)));
    let Some((track, (at_s, size))) = found else { return Ok(()) };
    if track.turns() && (size.abs() - std::f64::consts::TAU).abs() < TURN_RAD {
        return Err(ReplanFailure::Wraps { path: path.to_owned(), joint: track.name().to_owned(), at_s });
    }
    let (joint, size) = (track.name().to_owned(), track.kind().says(size));
    Err(ReplanFailure::Steps { path: path.to_owned(), joint, size, at_s })
}
