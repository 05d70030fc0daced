//! Poses of a tool among the tracks of a run.

use super::recording::ToolPoses;
use crate::{
    log::source::AXES,
    series::{JointKind, Quantity, Series, Signal, Track},
};

/// Takes the orientation of a tool out of the tracks of both sides: joints called as the components of a pose. Its
/// position stays among the joints, as three that slide. `None` where a side lacks a component.
pub(super) fn take(planned: &mut Series, measured: &mut Series) -> Option<ToolPoses> {
    let is_pose = |series: &Series| {
        let slides = |axis: &&str| series.track(axis).is_some_and(|track| track.kind() == JointKind::Slides);
        AXES[..3].iter().all(slides) && AXES[3..].iter().all(|axis| series.track(axis).is_some())
    };
    if !is_pose(planned) || !is_pose(measured) {
        return None;
    }
    let poses = [&*planned, &*measured].map(signal);
    for series in [planned, measured] {
        series.tracks.retain(|track| !AXES[3..].contains(&track.name()));
    }
    let [planned, measured] = poses;
    Some(ToolPoses { planned: planned?, measured: measured? })
}

/// The components as one signal; `None` where they are not all of the same instants.
fn signal(series: &Series) -> Option<Signal> {
    let tracks: Vec<&Track> = AXES.iter().map(|axis| series.track(axis)).collect::<Option<_>>()?;
    let t_s = tracks[0].t_s();
    if tracks.iter().any(|track| track.t_s() != t_s) {
        return None;
    }
    let mut values: Vec<f64> = tracks.iter().flat_map(|track| track.position()).copied().collect();
    let n = t_s.len();
    for i in 0..n {
        let norm = (3..7).map(|k| values[k * n + i].powi(2)).sum::<f64>().sqrt();
        if norm < 0.1 {
            return None;
        }
        (3..7).for_each(|k| values[k * n + i] /= norm);
    }
    let cuts: Vec<usize> = tracks[0].segments().iter().skip(1).map(|segment| segment.start).collect();
    Signal::new("tool", Quantity::Pose, t_s, values, &cuts).ok()
}
