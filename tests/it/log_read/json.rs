//! Messages in JSON.

use super::{file::Channel, *};

fn log_of(type_name: &str, message: impl Fn(i64, &[f64]) -> String) -> Log {
    let mut log = Log::of_plan();
    log.add(Channel::json("/joints", type_name), 0..SAMPLES, |k| message(k, &measurement(k)).into_bytes());
    log
}

fn seconds(k: i64) -> (i64, i64) {
    (stamp(k) / 1_000_000_000, stamp(k) % 1_000_000_000)
}

#[test]
fn foxglove_joint_states() {
    let log = log_of("foxglove.JointStates", |k, q| {
        let (sec, nsec) = seconds(k);
        format!(
            "{{\"timestamp\":{{\"sec\":{sec},\"nsec\":{nsec}}},\"joints\":[{{\"name\":\"a\",\"position\":{:?}}},\
             {{\"position\":{:?},\"velocity\":1.5,\"name\":\"b\"}},{{\"name\":\"hose\",\"effort\":3}}]}}",
            q[0], q[1]
        )
    });
    let recording = read(&log);
    assert_values(&recording.measured, measurement);
    assert_eq!(recording.source.time_base, hydrotrace::log::TimeBase::Header);
    assert!(recording.remarks.is_empty(), "{:?}", recording.remarks);
}

#[test]
fn a_group_without_a_name_or_a_number_shifts_no_other() {
    let log = log_of("foxglove.JointStates", |_, q| {
        format!(
            "{{\"joints\":[{{\"position\":7.0}},{{\"name\":\"a\"}},{{\"name\":\"b\",\"position\":{:?}}}]}}",
            q[1]
        )
    });
    let recording = read(&log);
    assert_eq!(recording.measured.track("a"), None);
    assert_eq!(recording.measured.track("b").unwrap().position()[3], measurement(3)[1]);
}

#[test]
fn joint_state_of_ros_in_json() {
    let log = log_of("sensor_msgs/msg/JointState", |k, q| {
        let (sec, nanosec) = seconds(k);
        format!(
            "{{\"header\":{{\"stamp\":{{\"sec\":{sec},\"nanosec\":{nanosec}}},\"frame_id\":\"\"}},\
             \"position\":[{:?},{:?}],\"name\":[\"a\",\"b\"]}}",
            q[0], q[1]
        )
    });
    let recording = read(&log);
    assert_values(&recording.measured, measurement);
    assert_eq!(recording.source.time_base, hydrotrace::log::TimeBase::Header);
}

#[test]
fn words_for_what_json_cannot_express_are_not_finite() {
    let log = log_of("sensor_msgs/msg/JointState", |k, q| {
        let word = ["\"NaN\"", "null", "\"-Infinity\"", "1e999"][k as usize % 4];
        let b = if k % 10 == 0 { word.to_owned() } else { format!("{:?}", q[1]) };
        format!("{{\"name\":[\"a\",\"b\"],\"position\":[{:?},{b}]}}", q[0])
    });
    let recording = read(&log);
    assert_eq!(recording.measured.track("b").unwrap().len(), 45);
    // A number beyond f64 is no JSON number: that message is lost as a whole.
    let (lost, unfinite) =
        (count(&recording.remarks, Code::UndecodableMessage), count(&recording.remarks, Code::NotFinite));
    assert_eq!(lost + unfinite, 5, "{:?}", recording.remarks);
}

#[test]
fn a_message_that_is_no_json_is_counted() {
    let log = log_of("sensor_msgs/msg/JointState", |k, q| match k {
        7 => "{\"name\":".to_owned(),
        8 => "[".repeat(100_000),
        9 => "[1,2]".to_owned(),
        10 => "\u{fffd}".to_owned(),
        _ => format!("{{\"name\":[\"a\",\"b\"],\"position\":[{:?},{:?}]}}", q[0], q[1]),
    });
    let recording = read(&log);
    assert_eq!(recording.measured.tracks[0].len(), 46);
    assert_eq!(count(&recording.remarks, Code::UndecodableMessage), 3, "{:?}", recording.remarks);
}

#[test]
fn trajectories_in_json() {
    let mut log = Log::default();
    add_joint_state(&mut log, "/joint_states", measurement);
    let channel = log.channel(Channel::json("/arm/joint_trajectory", "trajectory_msgs/msg/JointTrajectory"));
    let (sec, nanosec) = seconds(10);
    let text = format!(
        "{{\"points\":[{{\"time_from_start\":{{\"sec\":0,\"nanosec\":0}},\"positions\":[0.0,0.0]}},\
         {{\"positions\":[1.0,-1.0],\"time_from_start\":{{\"sec\":0,\"nanosec\":400000000}}}}],\
         \"joint_names\":[\"a\",\"b\"],\"header\":{{\"stamp\":{{\"sec\":{sec},\"nanosec\":{nanosec}}}}}}}"
    );
    log.send(channel, stamp(10), text.into_bytes());
    let recording = read(&log);
    let state = recording.planned.track("b").unwrap().at(0.4).unwrap();
    assert!((state.position + 0.5).abs() < 1e-9, "{state:?}");
}
