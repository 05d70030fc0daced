//! Whether a plan is one that a command can be corrected for.

use std::path::Path;

use super::ReplanFailure;
use crate::{
    log::Recording,
    replay::{Rules, planned_step},
    units::Degrees,
    workflow::carried::Carried,
};

/// No correction helps where a plan steps, and none is meant where strokes show what a machine cannot follow.
pub(super) fn correctable(path: &Path, run: &Recording, rules: &Rules) -> Result<(), ReplanFailure> {
    if Carried::identifies(run) {
        return Err(ReplanFailure::Identifies { path: path.to_owned() });
    }
    let mut turning = run.planned.tracks.iter().filter(|track| track.turns());
    let found = turning.find_map(|track| Some((track, planned_step(track, rules)?)));
    let Some((track, (at_s, size))) = found else { return Ok(()) };
    let (joint, size) = (track.name().to_owned(), Degrees(size).to_string());
    Err(ReplanFailure::Steps { path: path.to_owned(), joint, size, at_s })
}
