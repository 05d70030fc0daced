//! The tool of a run: how far it was from its plan, along and across the way, when it came to rest, and by which joint.

mod deviation;
mod instants;
mod outcome;
mod source;

use std::{ops::Range, sync::Arc};

use nalgebra::Vector3;

pub use outcome::{ToolCause, ToolDeviation, ToolPath, ToolReplay, ToolRest, ToolSplit, ToolWorst};

use super::{PathError, Rules, path::path_error, tracking::LONE_S};
use crate::{
    arm::Kinematics,
    series::{JointKind, Pair, PosePair},
    threads::numbered,
};
use deviation::angle_rad;
use instants::{Instants, around};
use source::{Joints, Source};

/// The tool of an arm over a run, and its way; `None` where a joint of the arm is not among the pairs, or all of them
/// share no instant. O(n) in instants.
pub fn tool_replay(arm: &Kinematics, pairs: &[Pair], rules: &Rules) -> Option<(ToolReplay, ToolPath)> {
    let of = |(name, kind)| pairs.iter().find(|pair| pair.name == name && pair.kind == kind);
    let own: Vec<&Pair> = arm.joints().map(of).collect::<Option<_>>()?;
    found(&Joints { arm, instants: Instants::of(&own, rules) }, arm.tool_name(), rules)
}

/// The same of poses that the log holds; no joint is known to cause anything.
pub fn pose_replay(poses: &PosePair, rules: &Rules) -> Option<(ToolReplay, ToolPath)> {
    found(poses, &poses.name, rules)
}

fn found(source: &impl Source, tool: &str, rules: &Rules) -> Option<(ToolReplay, ToolPath)> {
    let path = path(source, rules);
    let weights_s = weights_s(&path);
    let rests = rests(source, &path, rules);
    let worst = (0..path.t_s.len()).max_by(|a, b| path.error_m[*a].total_cmp(&path.error_m[*b]))?;
    let angle_rad = &path.orientation_rad;
    let turned = (0..angle_rad.len()).max_by(|a, b| angle_rad[*a].total_cmp(&angle_rad[*b]));
    let along_m = Some(path.along_m[worst]).filter(|along_m| along_m.is_finite());
    let window_s = [path.t_s[0], path.t_s[path.t_s.len() - 1]];
    let found = ToolReplay {
        tool: tool.to_owned(),
        samples: path.t_s.len(),
        sample_interval_s: (window_s[1] - window_s[0]) / (path.t_s.len() - 1).max(1) as f64,
        window_s,
        rms_m: rms(&weights_s, path.error_m.iter().copied()),
        mean_m: mean(&weights_s, &path.error_m),
        path_error: off_path(&path, rules),
        rms_orientation_rad: turned.map(|_| rms(&weights_s, angle_rad.iter().copied())),
        mean_orientation_rad: turned.map(|_| mean(&weights_s, angle_rad)),
        worst_orientation_rad: turned.map(|i| angle_rad[i]),
        worst_orientation_s: turned.map(|i| path.t_s[i]),
        worst: ToolWorst {
            time_s: path.t_s[worst],
            along_m,
            across_m: along_m.map(|along_m| across_m(path.error_m[worst], along_m)),
            deviation: source.deviation(worst..worst + 1),
        },
        split: split(&path, &weights_s),
        rests,
    };
    Some((found, path))
}

/// One instant: planned and measured position, m, and the angle between the orientations, rad.
type Row = ([Vector3<f64>; 2], f64);

fn path(source: &impl Source, rules: &Rules) -> ToolPath {
    let t_s = source.t_s();
    let row = |i: usize| -> Row {
        let poses = source.poses(i);
        (poses.each_ref().map(|pose| pose.translation.vector), angle_rad(&poses))
    };
    let rows: Vec<Row> = numbered(t_s.len(), row);
    let mut along_m = vec![f64::NAN; rows.len()];
    for segment in source.segments() {
        for i in segment.clone() {
            let [low, high] = around(t_s, segment, i, 0.5 * rules.planned_window_s);
            let step_m = rows[high].0[0] - rows[low].0[0];
            let slow_m = rules.sliding.stop_speed * (t_s[high] - t_s[low]);
            if let Some(direction) = step_m.try_normalize(slow_m.max(1e-12)) {
                along_m[i] = (rows[i].0[0] - rows[i].0[1]).dot(&direction);
            }
        }
    }
    ToolPath {
        t_s: t_s.to_vec(),
        planned_m: rows.iter().map(|row| row.0[0].into()).collect(),
        measured_m: rows.iter().map(|row| row.0[1].into()).collect(),
        error_m: rows.iter().map(|row| (row.0[0] - row.0[1]).norm()).collect(),
        along_m,
        orientation_rad: rows.iter().filter(|_| source.is_oriented()).map(|row| row.1).collect(),
        segments: source.segments().to_vec(),
    }
}

fn across_m(error_m: f64, along_m: f64) -> f64 {
    (error_m * error_m - along_m * along_m).max(0.0).sqrt()
}

/// The time that each instant stands for: half the way to its neighbours in its segment.
fn weights_s(path: &ToolPath) -> Vec<f64> {
    let t_s = &path.t_s;
    let weight_s = |own: &Range<usize>, i: usize| {
        let span_s = t_s[(i + 1).min(own.end - 1)] - t_s[i.saturating_sub(1).max(own.start)];
        (0.5 * span_s).max(LONE_S)
    };
    path.segments.iter().flat_map(|own| own.clone().map(move |i| weight_s(own, i))).collect()
}

fn mean(weights_s: &[f64], values: &[f64]) -> f64 {
    let sum: f64 = weights_s.iter().zip(values).map(|(weight_s, value)| weight_s * value).sum();
    sum / weights_s.iter().sum::<f64>()
}

fn rms(weights_s: &[f64], values: impl Iterator<Item = f64>) -> f64 {
    let squares: f64 = weights_s.iter().zip(values).map(|(weight_s, value)| weight_s * value * value).sum();
    (squares / weights_s.iter().sum::<f64>()).sqrt()
}

/// Distance to the planned path, whatever the time: that of three joints which slide along the axes.
fn off_path(path: &ToolPath, rules: &Rules) -> Option<PathError> {
    let t_s: Arc<[f64]> = path.t_s.as_slice().into();
    let pairs = [0, 1, 2].map(|k| Pair {
        name: String::new(),
        kind: JointKind::Slides,
        t_s: t_s.clone(),
        planned: path.planned_m.iter().map(|at| at[k]).collect(),
        planned_velocity: None,
        measured: path.measured_m.iter().map(|at| at[k]).collect(),
        segments: path.segments.clone(),
        planned_interval_s: 0.0,
        planned_step: None,
        matched: path.t_s.len(),
        unmatched: 0,
    });
    Some(path_error(&pairs.each_ref(), rules)?.1)
}

fn split(path: &ToolPath, weights_s: &[f64]) -> Option<ToolSplit> {
    let moving = || (0..path.t_s.len()).filter(|i| path.along_m[*i].is_finite());
    let (along, across) = (
        || moving().map(|i| path.along_m[i]),
        || moving().map(|i| across_m(path.error_m[i], path.along_m[i])),
    );
    let weights_s: Vec<f64> = moving().map(|i| weights_s[i]).collect();
    (!weights_s.is_empty()).then(|| ToolSplit {
        rms_along_m: rms(&weights_s, along()),
        rms_across_m: rms(&weights_s, across()),
        worst_along_m: along().map(f64::abs).fold(0.0, f64::max),
        worst_across_m: across().fold(0.0, f64::max),
        samples: weights_s.len(),
    })
}

/// Rests of the plan after a motion; a gap in which the plan stays where it was is in the middle of one.
fn rests(source: &impl Source, path: &ToolPath, rules: &Rules) -> Vec<ToolRest> {
    let t_s = source.t_s();
    let is_still = |segment: &Range<usize>, i: usize| {
        let [low, high] = around(t_s, segment, i, rules.window_min_s);
        t_s[high] > t_s[low] && source.rests([low, high], rules)
    };
    // Of each stretch of rest: whether a motion is seen before it.
    let mut stretches: Vec<(Range<usize>, bool)> = Vec::new();
    for segment in source.segments() {
        let still: Vec<bool> = segment.clone().map(|i| is_still(segment, i)).collect();
        let mut start = segment.start;
        for stretch in still.chunk_by(|a, b| a == b) {
            let own = start..start + stretch.len();
            start = own.end;
            let last = stretches.last_mut().filter(|(last, _)| last.end == own.start);
            match last.filter(|(last, _)| source.rests([last.end - 1, own.start], rules)) {
                _ if !stretch[0] => {}
                Some((last, _)) => last.end = own.end,
                None => stretches.push((own.clone(), own.start > segment.start)),
            }
        }
    }
    let mut found = Vec::new();
    for own in stretches.into_iter().filter(|(_, follows)| *follows).map(|(own, _)| own) {
        let [from_s, to_s] = [t_s[own.start], t_s[own.end - 1]];
        if to_s - from_s < rules.min_rest_s {
            continue;
        }
        let settled_s = to_s - rules.tool_rest_s.min(0.5 * (to_s - from_s));
        let settled = own.start + t_s[own.clone()].partition_point(|t| *t < settled_s)..own.end;
        found.push(ToolRest {
            from_s,
            to_s,
            at_end: own.end == t_s.len(),
            arrival_m: path.error_m[own.start],
            samples: settled.len(),
            deviation: source.deviation(settled),
        });
    }
    found
}
