//! Poses of a tool among the tracks of a run.

use nalgebra::UnitQuaternion;

use super::recording::ToolPoses;
use crate::{
    log::source::{AXES, unit},
    series::{JointKind, Quantity, Series, Signal, Track},
};

/// Angles about the fixed x, then y, then z, in place of a quaternion.
const TURNS: [&str; 3] = ["roll", "pitch", "yaw"];

/// Takes the orientation of a tool out of the tracks of both sides: joints called as the components of a pose. Its
/// position stays among the joints, as three that slide. `None` where a side has no position; its orientation is not
/// known where a side has none.
pub(super) fn take(planned: &mut Series, measured: &mut Series) -> Option<ToolPoses> {
    let all = |series: &Series, names: &[&str], kind| {
        names.iter().all(|name| series.track(name).is_some_and(|track| track.kind() == kind))
    };
    let sides = [&*planned, &*measured];
    if !sides.iter().all(|side| all(side, &AXES[..3], JointKind::Slides)) {
        return None;
    }
    let turns = sides.map(|side| {
        let known = [&AXES[3..], &TURNS[..]].into_iter();
        known.filter(|names| all(side, names, JointKind::Turns)).max_by_key(|names| names.len())
    });
    let known = turns.iter().all(Option::is_some);
    let poses = [0, 1].map(|k| signal(sides[k], turns[k].filter(|_| known).unwrap_or_default()));
    for (series, own) in [planned, measured].into_iter().zip(turns) {
        let turns = |track: &Track| own.is_some_and(|names| names.contains(&track.name()));
        series.tracks.retain(|track| !AXES[3..].contains(&track.name()) && !turns(track));
    }
    let [planned, measured] = poses;
    Some(ToolPoses { planned: planned?, measured: measured? })
}

/// Position and orientation as one signal; `None` where they are not all of the same instants.
fn signal(series: &Series, turns: &[&str]) -> Option<Signal> {
    let tracks: Vec<&Track> =
        AXES[..3].iter().chain(turns).map(|n| series.track(n)).collect::<Option<_>>()?;
    let t_s = tracks[0].t_s();
    if tracks.iter().any(|track| track.t_s() != t_s) {
        return None;
    }
    let mut values: Vec<f64> = tracks[..3].iter().flat_map(|track| track.position()).copied().collect();
    let n = t_s.len();
    values.resize(AXES.len() * n, 0.0);
    let mut before = [0.0; 4];
    for i in 0..n {
        let q = match tracks[3..] {
            [] => break,
            [roll, pitch, yaw] => {
                let [roll, pitch, yaw] = [roll, pitch, yaw].map(|track| track.position()[i]);
                UnitQuaternion::from_euler_angles(roll, pitch, yaw).coords.into()
            }
            ref all => std::array::from_fn(|k| all[k].position()[i]),
        };
        before = unit(q, &before)?;
        (0..4).for_each(|k| values[(3 + k) * n + i] = before[k]);
    }
    let cuts: Vec<usize> = tracks[0].segments().iter().skip(1).map(|segment| segment.start).collect();
    Signal::new("tool", Quantity::Pose, t_s, values, &cuts).ok()
}
