//! Whole plans in one message.

use super::{
    cdr::KINDS,
    encode::{Point, display, robot_trajectory, trajectory},
    file::Channel,
    *,
};

const TOPIC: &str = "/arm/joint_trajectory";

/// A measurement of ten seconds at rest, and a plan as the points say, sent at `at_ns`.
fn log_of(plans: &[(i64, i64, &[&str], Vec<Point>)], kind: cdr::Kind) -> Log {
    let mut log = Log::default();
    log.add(Channel::states("/joint_states"), 0..500, |k| {
        encode::joint_state(kind, stamp(k), &NAMES, &[1e-6 * k as f64, 1e-4 * k as f64], &[])
    });
    let channel = log.channel(Channel::cdr(TOPIC, "trajectory_msgs/msg/JointTrajectory"));
    for (at_ns, header_ns, names, points) in plans {
        log.send(channel, *at_ns, trajectory(kind, *header_ns, names, points));
    }
    log
}

fn points(of: &[(f64, f64, Option<f64>, Option<f64>)]) -> Vec<Point> {
    of.iter()
        .map(|&(since_s, q, v, a)| Point {
            position: vec![q, -q],
            velocity: v.map(|v| vec![v, -v]).unwrap_or_default(),
            acceleration: a.map(|a| vec![a, -a]).unwrap_or_default(),
            since_ns: (since_s * 1e9) as i64,
        })
        .collect()
}

#[track_caller]
fn assert_plan(recording: &Recording, t_s: f64, position: f64) {
    let state = recording.planned.track("a").unwrap().at(t_s).unwrap();
    assert!((state.position - position).abs() < 1e-9, "at {t_s} s {} for {position}", state.position);
    let mirrored = recording.planned.track("b").unwrap().at(t_s).unwrap();
    assert!((mirrored.position + position).abs() < 1e-9);
}

#[test]
fn lines_cubics_and_quintics_are_sampled_as_the_controller_does() {
    let end = |v, a| points(&[(0.0, 0.0, v, a), (2.0, 1.0, v, a)]);
    for kind in KINDS {
        // Smooth steps of half a second in: s = 0.25.
        for (given, at_quarter) in [
            (end(None, None), 0.25),
            (end(Some(0.0), None), 0.25 * 0.25 * (3.0 - 0.5)),
            (end(Some(0.0), Some(0.0)), 0.25_f64.powi(3) * (10.0 - 15.0 * 0.25 + 6.0 * 0.0625)),
        ] {
            let recording = read(&log_of(&[(stamp(40), stamp(50), &NAMES, given)], kind));
            assert_plan(&recording, 1.5, at_quarter);
            assert_plan(&recording, 0.5, 0.0);
            assert_plan(&recording, 9.0, 1.0);
            assert_eq!(recording.source.planned_field, "points.positions");
            assert!(recording.remarks.is_empty(), "{:?}", recording.remarks);
        }
    }
}

#[test]
fn a_stamp_of_zero_starts_on_receipt_and_is_said() {
    let given = points(&[(0.0, 0.0, None, None), (2.0, 1.0, None, None)]);
    let mut log = log_of(&[(stamp(50), 0, &NAMES, given)], cdr::Kind::LittleEndian);
    // The recorder is late by 30 ms, the trajectory too.
    for message in &mut log.messages {
        message.log_ns += 30_000_000;
    }
    let recording = read(&log);
    assert_plan(&recording, 2.0, 0.5);
    assert_eq!(codes(&recording.remarks), [Code::StartOnReceipt]);
}

#[test]
fn a_trajectory_that_another_clock_stamped_starts_on_receipt() {
    let sent = |at_ns, header_ns| {
        let given = points(&[(0.0, 0.0, None, None), (2.0, 1.0, None, None)]);
        read(&log_of(&[(at_ns, header_ns, &NAMES, given)], cdr::Kind::LittleEndian))
    };
    // Simulated time, and a clock that is an hour behind.
    for header_ns in [5_000_000_000, stamp(50) - 3_600_000_000_000] {
        let recording = sent(stamp(50), header_ns);
        assert_plan(&recording, 2.0, 0.5);
        assert_eq!(count(&recording.remarks, Code::UnusableStamp), 1, "{:?}", recording.remarks);
    }
    // What was received late, while it ran, was not.
    let recording = sent(stamp(90), stamp(50));
    assert_plan(&recording, 2.0, 0.5);
    assert!(recording.remarks.is_empty(), "{:?}", recording.remarks);
}

#[test]
fn a_newer_plan_replaces_and_an_empty_one_cancels() {
    let long = points(&[(0.0, 0.0, None, None), (4.0, 4.0, None, None)]);
    let back = points(&[(1.0, 0.0, None, None)]);
    let replaced = read(&log_of(
        &[(stamp(0), stamp(50), &NAMES, long.clone()), (stamp(90), stamp(100), &NAMES, back)],
        cdr::Kind::LittleEndian,
    ));
    assert_plan(&replaced, 2.0, 1.0);
    assert_plan(&replaced, 3.0, 0.0);
    assert_eq!(count(&replaced.remarks, Code::TrajectoryReplaced), 1);
    let cancelled = read(&log_of(
        &[(stamp(0), stamp(50), &NAMES, long), (stamp(100), stamp(100), &[], vec![])],
        cdr::Kind::LittleEndian,
    ));
    assert_plan(&cancelled, 1.5, 0.5);
    assert_plan(&cancelled, 5.0, 1.0);
    assert_eq!(count(&cancelled.remarks, Code::TrajectoryReplaced), 1);
}

#[test]
fn trajectories_that_do_not_fit_are_skipped_and_counted() {
    let good = points(&[(0.0, 0.0, None, None), (2.0, 1.0, None, None)]);
    let backwards = points(&[(2.0, 0.0, None, None), (1.0, 1.0, None, None)]);
    let not_finite = points(&[(0.0, f64::NAN, None, None)]);
    let short = vec![Point::at(&[1.0])];
    let log = log_of(
        &[
            (stamp(0), stamp(10), &NAMES, backwards),
            (stamp(1), stamp(20), &NAMES, short),
            (stamp(2), stamp(50), &NAMES, good),
            (stamp(3), stamp(90), &NAMES, not_finite),
        ],
        cdr::Kind::LittleEndian,
    );
    let recording = read(&log);
    assert_plan(&recording, 2.0, 0.5);
    assert_eq!(count(&recording.remarks, Code::LengthMismatch), 3);
}

#[test]
fn where_no_trajectory_can_be_used_the_reason_is_said() {
    let without_position = |mut points: Vec<Point>| {
        points.iter_mut().for_each(|point| point.position.clear());
        points
    };
    let speeds = without_position(points(&[(0.0, 0.0, Some(0.1), None), (2.0, 0.0, Some(0.2), None)]));
    let at_once = points(&[(0.0, 0.0, None, None), (0.0, 1.0, None, None)]);
    for (given, reason) in [
        (speeds, "points without positions, at most speeds"),
        (at_once, "points whose times from the start are all 0 s"),
    ] {
        let log = log_of(&[(stamp(50), stamp(50), &NAMES, given)], cdr::Kind::LittleEndian);
        let found = error(&log, &ReadOptions::default());
        assert!(
            found.contains(&format!("{TOPIC} (trajectory_msgs/msg/JointTrajectory, 1 message, of {reason})")),
            "{found}"
        );
        let found = error(&log, &options(&[TOPIC], &[], &[]));
        assert!(found.ends_with(&format!("it has {reason}")), "{found}");
    }
}

#[test]
fn a_planned_joint_that_no_topic_measures_is_said() {
    let given = vec![Point::at(&[0.0, 0.0, 0.0])];
    let recording =
        read(&log_of(&[(stamp(50), stamp(50), &["a", "boom", "b"], given)], cdr::Kind::LittleEndian));
    let unpaired: Vec<_> =
        recording.remarks.as_slice().iter().filter(|r| r.code == Code::UnpairedJoint).collect();
    assert_eq!(unpaired.len(), 1, "{:?}", recording.remarks);
    assert!(unpaired[0].message.contains("boom"), "{unpaired:?}");
}

#[test]
fn trajectories_of_moveit_are_read_where_the_file_does_not_describe_them() {
    let there = points(&[(0.0, 0.0, None, None), (2.0, 1.0, None, None)]);
    let kind = cdr::Kind::LittleEndian;
    let parts: &[(i64, &[&str], Vec<Point>)] = &[(stamp(50), &NAMES, there)];
    for (type_name, data) in [
        ("moveit_msgs/msg/RobotTrajectory", robot_trajectory(kind, &parts[0])),
        ("moveit_msgs/msg/DisplayTrajectory", display(kind, parts)),
    ] {
        for described in [true, false] {
            let mut log = log_of(&[], kind);
            log.channels.pop();
            let channel = Channel::cdr("/plan_to_run", type_name);
            let channel = if described { channel } else { channel.with_schema("ros2msg", "") };
            log.add(channel, 40..41, |_| data.clone());
            let recording = read(&log);
            assert_plan(&recording, 2.0, 0.5);
            assert!(recording.remarks.is_empty(), "{type_name} {:?}", recording.remarks);
        }
    }
}

#[test]
fn a_displayed_plan_of_several_parts_is_read_in_every_encoding() {
    for kind in KINDS {
        let mut log = log_of(&[], kind);
        log.channels.pop();
        let channel = log.channel(Channel::cdr("/display_planned_path", "moveit_msgs/msg/DisplayTrajectory"));
        let there = points(&[(0.0, 0.0, None, None), (2.0, 1.0, None, None)]);
        let on = points(&[(0.0, 1.0, None, None), (2.0, 2.0, None, None)]);
        log.send(channel, stamp(50), display(kind, &[(0, &NAMES, there), (0, &NAMES, on)]));
        let recording = read(&log);
        assert_plan(&recording, 2.0, 0.5);
        assert_plan(&recording, 4.0, 1.5);
        assert_eq!(codes(&recording.remarks), [Code::StartOnReceipt], "{kind:?} {:?}", recording.remarks);
        let message = &recording.remarks.as_slice()[0].message;
        assert!(message.contains("when they were executed is not known"), "{message}");
        // What was sent counts more.
        let channel = log.channel(Channel::cdr(TOPIC, "trajectory_msgs/msg/JointTrajectory"));
        let sent = points(&[(0.0, 0.0, None, None), (2.0, 1.0, None, None)]);
        log.send(channel, stamp(80), trajectory(kind, 0, &NAMES, &sent));
        let recording = read(&log);
        assert_plan(&recording, 2.6, 0.5);
        assert_eq!(recording.source.planned_topic, TOPIC);
    }
}
