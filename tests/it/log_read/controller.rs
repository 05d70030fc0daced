//! The state of a joint trajectory controller, five layouts under one name.

use super::{
    cdr::KINDS,
    encode::{Point, controller_state},
    file::Channel,
    *,
};

const TYPE: &str = "control_msgs/msg/JointTrajectoryControllerState";
const HUMBLE: [&str; 6] = ["reference", "feedback", "error", "output", "desired", "actual"];
const IRON: [&str; 4] = ["reference", "feedback", "error", "output"];
const OLD: [&str; 3] = ["desired", "actual", "error"];

/// A topic of this layout; points that are not listed in `filled` are empty.
fn add(
    log: &mut Log,
    topic: &str,
    points: &[&str],
    more: (bool, Option<f64>),
    filled: &[&str],
    kind: cdr::Kind,
) {
    let schema = schema::controller_state(points, more.0, more.1.is_some());
    log.add(Channel::cdr(topic, TYPE).with_schema("ros2msg", schema), 0..SAMPLES, |k| {
        let value = |point: &&str| match *point {
            _ if !filled.contains(point) => Point::default(),
            "desired" | "reference" => Point::at(&plan(k)),
            "actual" | "feedback" => Point::at(&measurement(k)),
            _ => Point::at(&[0.005, 0.005]),
        };
        let points: Vec<Point> = points.iter().map(value).collect();
        controller_state(kind, stamp(k), &NAMES, &points, more.0, more.1)
    });
}

fn one(points: &[&str], more: (bool, Option<f64>), filled: &[&str], kind: cdr::Kind) -> Recording {
    let mut log = Log::default();
    add(&mut log, "/arm/controller_state", points, more, filled, kind);
    let recording = read(&log);
    assert_usual(&recording);
    assert_eq!(codes(&recording.remarks), [], "{:?}", recording.remarks);
    recording
}

#[test]
fn every_layout_in_every_encoding_yields_plan_and_measurement() {
    for kind in KINDS {
        for (points, more) in [
            (&OLD[..], (false, None)),
            (&OLD, (true, None)),
            (&HUMBLE, (true, None)),
            (&IRON, (true, None)),
            (&IRON, (true, Some(1.0))),
        ] {
            let source = one(points, more, points, kind).source;
            let (planned, measured) =
                if points.len() == 3 { ("desired", "actual") } else { ("reference", "feedback") };
            assert_eq!(source.planned_field, format!("{planned}.positions"));
            assert_eq!(source.measured_field, format!("{measured}.positions"));
        }
    }
}

#[test]
fn in_humble_the_fields_that_are_filled_are_used() {
    let kind = cdr::Kind::LittleEndian;
    let old = one(&HUMBLE, (true, None), &["desired", "actual", "error"], kind);
    assert_eq!(old.source.planned_field, "desired.positions");
    let new = one(&HUMBLE, (true, None), &["reference", "feedback", "error", "output"], kind);
    assert_eq!(new.source.planned_field, "reference.positions");
}

#[test]
fn the_two_topics_of_humble_are_not_counted_twice() {
    let mut log = Log::default();
    let kind = cdr::Kind::LittleEndian;
    add(&mut log, "/arm/state", &HUMBLE, (true, None), &["desired", "actual", "error"], kind);
    add(
        &mut log,
        "/arm/controller_state",
        &HUMBLE,
        (true, None),
        &["reference", "feedback", "error", "output"],
        kind,
    );
    add_joint_state(&mut log, "/joint_states", |k| vec![k as f64, 0.0]);
    let recording = read(&log);
    assert_eq!(recording.source.planned_topic, "/arm/controller_state");
    assert_eq!(recording.source.measured_topic, "/arm/controller_state");
    assert_eq!(recording.source.messages as i64, SAMPLES);
    assert_usual(&recording);
}

#[test]
fn two_controllers_of_different_joints_are_both_read() {
    let mut log = Log::default();
    for (topic, names) in [("/left/controller_state", ["a", "b"]), ("/right/controller_state", ["c", "d"])] {
        let schema = schema::controller_state(&IRON, true, false);
        log.add(Channel::cdr(topic, TYPE).with_schema("ros2msg", schema), 0..SAMPLES, |k| {
            let points = [plan(k), measurement(k), vec![], vec![]].map(|q| Point::at(&q));
            controller_state(cdr::Kind::LittleEndian, stamp(k), &names, &points, true, None)
        });
    }
    let recording = read(&log);
    assert_eq!(joints(&recording.planned), ["a", "b", "c", "d"]);
    assert_eq!(joints(&recording.measured), ["a", "b", "c", "d"]);
}

#[test]
fn action_feedback_without_a_schema_is_read() {
    for (kind, stored) in KINDS.into_iter().flat_map(|kind| [(kind, "unknown"), (kind, "none"), (kind, "")]) {
        let mut log = Log::default();
        let topic = "/arm/follow_joint_trajectory/_action/feedback";
        let name = "control_msgs/action/FollowJointTrajectory_FeedbackMessage";
        log.add(Channel::cdr(topic, name).with_schema(stored, ""), 0..SAMPLES, |k| {
            cdr::Cdr::message(kind, |cdr| {
                cdr.record(|cdr| (0..16).for_each(|byte| cdr.u8(byte)));
                cdr.record(|cdr| {
                    cdr.header(stamp(k));
                    cdr.texts(&NAMES);
                    [plan(k), measurement(k), vec![0.005; 2]].iter().for_each(|q| Point::at(q).write(cdr));
                    // Later versions go on.
                    cdr.u32(0);
                    cdr.u32(0);
                });
            })
        });
        if stored == "none" {
            // Without a schema record there is no type name either.
            assert!(error(&log, &ReadOptions::default()).contains(topic));
            continue;
        }
        let recording = read(&log);
        assert_eq!(recording.source.planned_field, "feedback.desired.positions");
        assert_usual(&recording);
    }
}

#[test]
fn any_point_can_be_named() {
    let mut log = Log::default();
    add(&mut log, "/arm/controller_state", &IRON, (true, Some(1.0)), &IRON, cdr::Kind::LittleEndian);
    let topic = |field| format!("/arm/controller_state:{field}.positions");
    let recording = read_with(&log, &options(&[&topic("output")], &[&topic("error")], &[]));
    assert_eq!(recording.source.planned_field, "output.positions");
    assert_values(&recording.measured, |_| vec![0.005, 0.005]);
    let absent = error(&log, &options(&[&topic("desired")], &[], &[]));
    assert!(
        absent.contains("in field \"desired.positions\"")
            && absent.ends_with("it has reference.positions, feedback.positions"),
        "{absent}"
    );
}
