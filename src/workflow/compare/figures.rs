//! Whole runs before and after.

use serde::Serialize;

use super::Change;
use crate::{
    replay::{JointReplay, PathError, Rules, TrackingError},
    series::local_quadratic,
    workflow::report::Report,
};

/// Whole-run figures of one joint, or of all together.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Figures {
    /// The joint; `None` for all together.
    pub joint: Option<String>,
    /// Root mean square error, rad.
    pub rms_rad: Change,
    /// Magnitude exceeded for 5 % of the time, rad; of all joints only where every run has the same.
    pub p95_rad: Change,
    /// Largest error, rad.
    pub peak_rad: Change,
    /// Root mean square error at standstill, rad.
    pub standstill_rms_rad: Change,
    /// Root mean square distance to the planned path, ignoring time, rad; of all joints only where every run
    /// has the same.
    pub path_rms_rad: Change,
    /// Velocity lag, s; of all joints their mean.
    pub lag_s: Change,
    /// Largest measured speed, rad/s, smoothed equally before and after.
    pub peak_speed_rad_s: Change,
    /// Largest measured acceleration, rad/s², smoothed equally before and after.
    pub peak_acceleration_rad_s2: Change,
}

/// Figures of one run; angles rad, times s.
#[derive(Debug, Clone, Copy, Default)]
struct Values {
    rms: Option<f64>,
    p95: Option<f64>,
    peak: Option<f64>,
    standstill: Option<f64>,
    path: Option<f64>,
    lag: Option<f64>,
    speed: Option<f64>,
    acceleration: Option<f64>,
}

/// All joints together, then each joint.
pub(super) fn figures(before: &[Report], after: &[Report], joints: &[String], rules: &Rules) -> Vec<Figures> {
    let all = || before.iter().chain(after);
    let windows_s: Vec<f64> = joints
        .iter()
        .map(|joint| {
            all().filter_map(|r| joint_of(r, joint)).map(|j| j.thresholds.window_s).fold(0.0, f64::max)
        })
        .collect();
    let of = |reports: &[Report]| -> Vec<Vec<Values>> {
        let values = |report: &Report| {
            let each: Vec<Values> = joints
                .iter()
                .zip(&windows_s)
                .map(|(joint, window_s)| values(report, joint, *window_s, rules))
                .collect();
            let mut rows = vec![together(report, joints, &each)];
            rows.extend(each);
            rows
        };
        reports.iter().map(values).collect()
    };
    let (before, after) = (of(before), of(after));
    let names = std::iter::once(None).chain(joints.iter().cloned().map(Some));
    names
        .enumerate()
        .map(|(row, joint)| {
            let change = |of: fn(&Values) -> Option<f64>| {
                let side = |runs: &[Vec<Values>]| {
                    runs.iter().map(|rows| rows.get(row).and_then(of)).collect::<Vec<_>>()
                };
                Change::of_runs(&side(&before), &side(&after))
            };
            Figures {
                joint,
                rms_rad: change(|v| v.rms),
                p95_rad: change(|v| v.p95),
                peak_rad: change(|v| v.peak),
                standstill_rms_rad: change(|v| v.standstill),
                path_rms_rad: change(|v| v.path),
                lag_s: change(|v| v.lag),
                peak_speed_rad_s: change(|v| v.speed),
                peak_acceleration_rad_s2: change(|v| v.acceleration),
            }
        })
        .collect()
}

fn joint_of<'a>(report: &'a Report, name: &str) -> Option<&'a JointReplay> {
    report.replay.joints.iter().find(|joint| joint.name == name)
}

fn values(report: &Report, name: &str, window_s: f64, rules: &Rules) -> Values {
    let Some(joint) = joint_of(report, name) else { return Values::default() };
    let pair = report.pairs.iter().find(|pair| pair.name == name);
    let fits = pair.map_or_else(Vec::new, |pair| {
        local_quadratic(&pair.t_s, &pair.measured, &pair.segments, window_s, rules.window_points)
    });
    // At the ends of a segment a window is cut, and what it yields is mostly noise.
    let whole: Vec<bool> = pair.map_or_else(Vec::new, |pair| {
        let inside = |segment: &std::ops::Range<usize>| {
            let (first_s, last_s) = (pair.t_s[segment.start], pair.t_s[segment.end - 1]);
            let whole = move |t_s: &f64| *t_s - first_s >= window_s && last_s - *t_s >= window_s;
            pair.t_s[segment.clone()].iter().map(whole).collect::<Vec<_>>()
        };
        pair.segments.iter().flat_map(inside).collect()
    });
    let inside = || fits.iter().zip(&whole).filter(|(_, whole)| **whole).map(|(fit, _)| fit);
    let peak = |values: &mut dyn Iterator<Item = f64>| values.map(f64::abs).reduce(f64::max);
    Values {
        rms: Some(joint.tracking_error.rms_rad),
        p95: Some(joint.tracking_error.p95_rad),
        peak: Some(joint.tracking_error.peak_rad),
        standstill: joint.standstill_error.map(|error| error.rms_rad),
        path: joint.path_error.map(|error| error.rms_rad),
        lag: joint.lag_s,
        speed: peak(&mut inside().map(|fit| fit.velocity)),
        acceleration: peak(&mut inside().map(|fit| fit.acceleration)),
    }
}

fn together(report: &Report, joints: &[String], each: &[Values]) -> Values {
    let replay = &report.replay;
    let common: Vec<&JointReplay> = joints.iter().filter_map(|joint| joint_of(report, joint)).collect();
    let complete = common.len() == replay.joints.len();
    let most = |of: fn(&Values) -> Option<f64>| each.iter().filter_map(of).reduce(f64::max);
    let whole = replay.whole_run.tracking_error.filter(|_| complete);
    let lags: Vec<f64> = each.iter().filter_map(|values| values.lag).collect();
    Values {
        rms: pooled(common.iter().map(|joint| joint.tracking_error)),
        p95: whole.map(|error| error.p95_rad),
        peak: most(|values| values.peak),
        standstill: pooled(common.iter().filter_map(|joint| joint.standstill_error)),
        path: replay.whole_run.path_error.filter(|_| complete).map(|error: PathError| error.rms_rad),
        lag: (!lags.is_empty()).then(|| lags.iter().sum::<f64>() / lags.len() as f64),
        speed: most(|values| values.speed),
        acceleration: most(|values| values.acceleration),
    }
}

/// Root mean square over several, weighted by time.
fn pooled(errors: impl Iterator<Item = TrackingError>) -> Option<f64> {
    let (square, time_s) = errors.fold((0.0, 0.0), |(square, time_s), error| {
        (square + error.rms_rad * error.rms_rad * error.duration_s, time_s + error.duration_s)
    });
    (time_s > 0.0).then(|| (square / time_s).sqrt())
}
