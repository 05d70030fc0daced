//! From trajectory messages to the plan at the measured stamps.

use std::collections::BTreeSet;

use super::quality;
use crate::{
    log::{
        options::TimeBase,
        source::{Plans, RawTrajectory, Stamps},
    },
    remark::{Code, Remarks},
    series::{JointKind, PlannedPoint, PlannedTrajectory, Series, Track, plan_tracks},
    units::{NS_PER_S, radians_from_degrees, seconds_since},
};

/// How the numbers of trajectories are to be read.
pub(super) struct Reading<'a> {
    pub(super) base: TimeBase,
    pub(super) epoch_ns: i64,
    /// Stamps of the measurement, which tell how late messages are received.
    pub(super) measured: Option<&'a Stamps>,
    pub(super) degrees: bool,
    pub(super) topic: &'a str,
    /// Whether they are what a planner shows, and not what it sends.
    pub(super) shown: bool,
}

/// The plan of every measured joint; `kind` says how a joint moves, and what its numbers are multiplied with.
pub(super) fn planned(
    plans: &Plans,
    reading: &Reading<'_>,
    kind: impl Fn(&str) -> (JointKind, f64),
    measured: &Series,
    remarks: &mut Remarks,
) -> Vec<Track> {
    let mut trajectories = trajectories(plans, reading, kind, remarks);
    trajectories.sort_by(|a, b| a.start_s.total_cmp(&b.start_s));
    let (series, replaced) = plan_tracks(&trajectories, measured);
    remarks.add(
        Code::TrajectoryReplaced,
        replaced,
        format!("trajectories of {} that the next one, or a cancel, cut short", reading.topic),
    );
    let joints: BTreeSet<&str> =
        trajectories.iter().flat_map(|t| &t.joints).map(|(joint, _)| joint.as_str()).collect();
    for joint in joints.into_iter().filter(|joint| measured.track(joint).is_none()) {
        quality::unmeasured(joint, remarks);
    }
    series.tracks
}

/// A trajectory that was over so long before it was received is stamped by another clock.
const OVER_NS: i64 = 2_000_000_000;

fn trajectories(
    plans: &Plans,
    reading: &Reading<'_>,
    kind: impl Fn(&str) -> (JointKind, f64),
    remarks: &mut Remarks,
) -> Vec<PlannedTrajectory> {
    let Reading { base, epoch_ns, topic, .. } = *reading;
    let delays_ns = reading.measured.filter(|_| base == TimeBase::Header).and_then(Stamps::delays_ns);
    // Least delay from header to recorder and the spread up to the median, ns.
    let (delay_ns, spread_ns) = delays_ns.map_or((0, 0), |[least, middle, _]| (least, middle - least));
    let mut out: Vec<PlannedTrajectory> = Vec::new();
    let mut previous_end_s = 0.0;
    for raw in &plans.trajectories {
        let lasts_ns = raw.points.last().map_or(0, |last| last.since_start_ns);
        let late_ns = raw.log_ns.saturating_sub(delay_ns).saturating_sub(raw.header_ns);
        let is_over = late_ns > lasts_ns.saturating_add(OVER_NS);
        if raw.header_ns != 0 && base == TimeBase::Header && is_over {
            let message = format!(
                "trajectories of {topic} whose stamp has them over before they were received, by {:.1} s: another clock; they \
                 start when received",
                late_ns as f64 / NS_PER_S
            );
            remarks.add(Code::UnusableStamp, 1, message);
        }
        let start_s = if raw.place > 0 && raw.header_ns == 0 {
            previous_end_s
        } else if raw.header_ns != 0 && base == TimeBase::Header && !is_over {
            seconds_since(epoch_ns, raw.header_ns)
        } else {
            let received_ns = if base == TimeBase::Publish { raw.publish_ns } else { raw.log_ns };
            let message = if reading.shown {
                format!(
                    "trajectories of {topic} are what a planner shows, not what it sends: they are taken to start when \
                     received, and when they were executed is not known, so that delays and lags may be off by any time"
                )
            } else {
                let known_ms = (spread_ns as f64 / 1e6).max(1.0);
                format!(
                    "trajectories of {topic} start when received; that is known to about {known_ms:.0} ms"
                )
            };
            remarks.add(Code::StartOnReceipt, 1, message);
            seconds_since(epoch_ns, received_ns.saturating_sub(delay_ns))
        };
        if let Some(fault) = raw.fault() {
            remarks.add(Code::LengthMismatch, 1, format!("trajectories of {topic} with {fault}, skipped"));
            continue;
        }
        let one = trajectory(raw, start_s, reading.degrees, &kind);
        let ends_s = one.joints.iter().filter_map(|(_, points)| points.last()).map(|point| point.t_s);
        previous_end_s = ends_s.fold(start_s, f64::max);
        out.push(one);
    }
    out
}

fn trajectory(
    raw: &RawTrajectory,
    start_s: f64,
    degrees: bool,
    kind: &impl Fn(&str) -> (JointKind, f64),
) -> PlannedTrajectory {
    if raw.points.is_empty() {
        return PlannedTrajectory { start_s, joints: Vec::new() };
    }
    let joints = (0..raw.joints.len()).map(|j| {
        let (kind, factor) = kind(&raw.joints[j]);
        let degrees = degrees && kind == JointKind::Turns;
        let unit = |value: f64| if degrees { radians_from_degrees(value) } else { factor * value };
        let points = raw.points.iter().map(|p| PlannedPoint {
            t_s: start_s + seconds_since(0, p.since_start_ns),
            position: unit(p.positions[j]),
            velocity: p.velocities.get(j).map(|&v| unit(v)),
            acceleration: p.accelerations.get(j).map(|&a| unit(a)),
        });
        (raw.joints[j].clone(), points.collect())
    });
    PlannedTrajectory { start_s, joints: joints.collect() }
}
