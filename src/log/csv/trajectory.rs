//! Messages that are trajectories, as JSON or as `ros2 topic echo` prints them: the plan over time, by the rule of the controller.

use std::collections::BTreeSet;

use serde_json::{Map, Value};

use super::{
    Separator,
    members::{LISTS, listed},
    rows::writer,
};
use crate::{
    series::{JointKind, PlannedPoint, PlannedTrajectory, Series, Track, plan_tracks},
    units::{NS_PER_S, whole_ns},
};

/// The plan has a row so often, s, and at most so many rows.
const STEP_S: f64 = 0.01;
const MOST_ROWS: usize = 100_000;

/// What is nested deeper is no trajectory.
const DEEPEST: usize = 4;

/// When a trajectory begins, ns, and its points from then on.
pub(super) struct Planned {
    start_ns: i64,
    points: PlannedTrajectory,
}

/// The trajectory that a message is or holds; `None` of another one.
pub(super) fn of(message: &Map<String, Value>) -> Option<Planned> {
    within(message, DEEPEST)
}

fn within(message: &Map<String, Value>, depth: usize) -> Option<Planned> {
    let own = || {
        let names = LISTS.iter().any(|key| message.contains_key(*key)).then(|| listed(message)).flatten()?;
        let points: Vec<(f64, &Map<String, Value>)> =
            message.get("points")?.as_array()?.iter().map(point).collect::<Option<_>>()?;
        let rises = points.windows(2).all(|two| two[0].0 < two[1].0);
        let joint = |(at, name): (usize, &&str)| {
            let point = |(t_s, point): &(f64, &Map<String, Value>)| {
                let of = |key: &str| number_at(point, key, at, names.len());
                Some(PlannedPoint {
                    t_s: *t_s,
                    position: of("positions")?,
                    velocity: of("velocities"),
                    acceleration: of("accelerations"),
                })
            };
            Some(((*name).to_owned(), points.iter().map(point).collect::<Option<_>>()?))
        };
        let joints = names.iter().enumerate().map(joint).collect::<Option<_>>()?;
        let stamp = message.get("header").and_then(|header| header.get("stamp")).and_then(seconds);
        let start_ns = stamp.and_then(|s| whole_ns(s * NS_PER_S)).unwrap_or(0);
        let sound = rises && points.first().is_some_and(|(first, _)| *first >= 0.0);
        sound.then_some(Planned { start_ns, points: PlannedTrajectory { start_s: 0.0, joints } })
    };
    own().or_else(|| {
        let inner = |value: &Value| match value {
            Value::Object(object) => within(object, depth - 1),
            Value::Array(list) if list.len() == 1 => within(list[0].as_object()?, depth - 1),
            _ => None,
        };
        message.values().filter(|_| depth > 0).find_map(inner)
    })
}

fn point(value: &Value) -> Option<(f64, &Map<String, Value>)> {
    let point = value.as_object()?;
    Some((seconds(point.get("time_from_start")?)?, point))
}

/// A number of a list that is as long as the joints are many.
fn number_at(point: &Map<String, Value>, key: &str, at: usize, joints: usize) -> Option<f64> {
    let list = point.get(key)?.as_array().filter(|list| list.len() == joints)?;
    list.get(at)?.as_f64()
}

/// A time or a span: a number, or seconds and what is beyond them.
fn seconds(value: &Value) -> Option<f64> {
    let part = |names: [&str; 3]| names.iter().find_map(|name| value.get(name)?.as_f64());
    let parts = || Some(part(["sec", "secs", "s"])? + part(["nanosec", "nsecs", "nsec"])? / NS_PER_S);
    value.as_f64().or_else(parts)
}

/// The plan that trajectories are one after the other, a row so often; `None` of none, or of several that say not when.
pub(super) fn table(mut all: Vec<Planned>) -> Option<Vec<u8>> {
    let zero_ns = all.iter().map(|one| one.start_ns).min()?;
    if all.len() > 1 && zero_ns == 0 {
        return None;
    }
    all.sort_by_key(|one| one.start_ns);
    for one in &mut all {
        let start_s = one.start_ns.saturating_sub(zero_ns) as f64 / NS_PER_S;
        one.points.start_s = start_s;
        for point in one.points.joints.iter_mut().flat_map(|(_, points)| points) {
            point.t_s += start_s;
        }
    }
    let plans: Vec<PlannedTrajectory> = all.into_iter().map(|one| one.points).collect();
    let joints = || plans.iter().flat_map(|plan| &plan.joints);
    let end_s = joints().filter_map(|(_, points)| points.last()).fold(0.0_f64, |end, last| end.max(last.t_s));
    let step_s = STEP_S.max(end_s / MOST_ROWS as f64);
    let mut t_s: Vec<f64> =
        (0..=MOST_ROWS).map(|k| k as f64 * step_s).take_while(|t_s| *t_s < end_s).collect();
    t_s.push(end_s);
    // At rest where its first plan begins.
    let at_rest = |name: &&str| {
        let first = joints().find(|(other, _)| other == name)?.1.first()?.position;
        Track::of(JointKind::Turns, *name, t_s.as_slice(), vec![first; t_s.len()], &[]).ok()
    };
    let names: BTreeSet<&str> = joints().map(|(name, _)| name.as_str()).collect();
    let tracks = names.iter().map(at_rest).collect::<Option<Vec<Track>>>()?;
    let planned = plan_tracks(&plans, &Series { tracks }).0.tracks;
    let mut out = writer(Separator::Byte(b','));
    let headers = planned.iter().map(|track| format!("{}.planned_position", track.name()));
    out.write_record(std::iter::once("time_ns".to_owned()).chain(headers)).ok()?;
    for (row, t_s) in t_s.iter().enumerate() {
        let stamp_ns = zero_ns.saturating_add(whole_ns(t_s * NS_PER_S)?);
        let positions = planned.iter().map(|track| track.position().get(row).map(f64::to_string));
        let cells = positions.map(Option::unwrap_or_default);
        out.write_record(std::iter::once(stamp_ns.to_string()).chain(cells)).ok()?;
    }
    out.into_inner().ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::csv::{CsvOptions, Role, read_csv_bytes};

    #[test]
    fn a_trajectory_is_a_plan_between_its_points_in_either_form() {
        let json = r#"{"header": {"stamp": {"sec": 0, "nanosec": 0}}, "joint_names": ["boom", "stick"], "points": [
            {"positions": [0.0, 1.0], "velocities": [0.0, 0.0], "time_from_start": {"sec": 0, "nanosec": 0}},
            {"positions": [0.5, 1.0], "velocities": [0.0, 0.0], "time_from_start": {"sec": 2, "nanosec": 0}}]}"#;
        let yaml = "header:\n  stamp: {sec: 0, nanosec: 0}\njoint_names: [boom, stick]\npoints:\n\
                    - {positions: [0.0, 1.0], velocities: [0, 0], time_from_start: {sec: 0, nanosec: 0}}\n\
                    - {positions: [0.5, 1.0], velocities: [0, 0], time_from_start: {sec: 2, nanosec: 0}}\n---\n";
        for text in [json, yaml] {
            let run = read_csv_bytes("a.json", text.as_bytes(), &CsvOptions::default()).unwrap();
            let boom = run.by_joint(Role::Planned, super::super::Quantity::Position).unwrap()[0].unwrap();
            // A cubic is at half of the way in the middle, and at 5/32 after a quarter of the time.
            let [quarter, half] = [50, 100].map(|row| boom[row]);
            assert!((half - 0.25).abs() < 1e-9 && (quarter - 0.078_125).abs() < 1e-9, "{quarter} {half}");
            assert_eq!(boom.len(), 201);
        }
        let falls = json.replace("\"sec\": 2", "\"sec\": -2");
        assert!(of(&serde_json::from_str(&falls).unwrap()).is_none());
    }
}
