//! Which joints of a source are kept.

use crate::{
    log::error::LogError,
    series::{Series, Track},
    suggest::nearest,
};

/// Adds the joints that are not there yet.
pub(super) fn add_new(series: &mut Series, tracks: Vec<Track>) {
    for track in tracks {
        if series.track(track.name()).is_none() {
            series.tracks.push(track);
        }
    }
}

/// Keeps the joints that the caller named, in the caller's order; a side that is not there has none.
pub(super) fn keep_joints(series: &mut Series, wanted: &[String]) -> Result<(), LogError> {
    if wanted.is_empty() || series.tracks.is_empty() {
        return Ok(());
    }
    let mut kept = Vec::with_capacity(wanted.len());
    for (place, name) in wanted.iter().enumerate() {
        if wanted[..place].contains(name) {
            return Err(LogError::JointTwice { joint: name.clone() });
        }
        let track = series.track(name).ok_or_else(|| LogError::NoJoint {
            joint: name.clone(),
            nearest: nearest(name, series.tracks.iter().map(Track::name)),
            present: series.tracks.iter().map(Track::name).collect::<Vec<_>>().join(", "),
        })?;
        kept.push(track.clone());
    }
    series.tracks = kept;
    Ok(())
}
