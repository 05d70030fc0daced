//! What is doubtful inside the data arises as a remark and is counted.

use super::{cdr::Kind, encode, file::Channel, *};

/// Measured messages as `message` gives them (names, positions), against the usual plan.
fn log_of(message: impl Fn(i64) -> (Vec<&'static str>, Vec<f64>)) -> Log {
    let mut log = Log::of_plan();
    log.add(Channel::states("/joint_states"), 0..SAMPLES, |k| {
        let (names, position) = message(k);
        states(k, &names, &position)
    });
    log
}

#[test]
fn nan_is_dropped_for_its_joint_alone() {
    let recording = read(&log_of(|k| {
        let mut q = measurement(k);
        if k % 5 == 0 {
            q[0] = [f64::NAN, f64::INFINITY][k as usize / 5 % 2];
        }
        (NAMES.to_vec(), q)
    }));
    assert_eq!((recording.measured.tracks[0].len(), recording.measured.tracks[1].len()), (40, 50));
    assert_eq!(codes(&recording.remarks), [Code::NotFinite]);
    assert_eq!(count(&recording.remarks, Code::NotFinite), 10);
}

#[test]
fn plan_and_measurement_that_two_clocks_stamped_are_told() {
    for (late_ms, told) in [(20, 0), (250, 1)] {
        let mut log = plain_log();
        log.messages
            .iter_mut()
            .filter(|message| message.channel == 0)
            .for_each(|message| message.log_ns += late_ms * 1_000_000);
        let recording = read(&log);
        assert_eq!(count(&recording.remarks, Code::Guessed), told, "{late_ms} ms: {:?}", recording.remarks);
    }
}

#[test]
fn arrays_of_another_length_than_the_names_are_left_out() {
    let recording =
        read(&log_of(|k| (NAMES.to_vec(), if k % 10 == 0 { vec![0.0; 3] } else { measurement(k) })));
    assert_eq!(recording.measured.tracks[0].len(), 45);
    assert_eq!(count(&recording.remarks, Code::LengthMismatch), 5);
}

#[test]
fn a_list_of_no_names_does_not_borrow_those_of_the_message_before() {
    let recording =
        read(&log_of(|k| if k == 20 { (vec![], vec![9.0, 8.0]) } else { (NAMES.to_vec(), measurement(k)) }));
    for track in recording.measured.tracks.iter().filter(|track| NAMES.contains(&track.name())) {
        assert_eq!(track.len(), 49, "{}", track.name());
    }
}

#[test]
fn degrees_are_noticed_never_rescaled_unless_told() {
    let degrees =
        |k| (NAMES.to_vec(), measurement(k).iter().map(|q| q * 180.0 / std::f64::consts::PI).collect());
    let recording = read(&log_of(degrees));
    assert_eq!(count(&recording.remarks, Code::LooksLikeDegrees), 2);
    assert!(recording.measured.tracks[0].position()[49] > 20.0);
    let told = ReadOptions { measured_in_degrees: true, ..ReadOptions::default() };
    let recording = read_with(&log_of(degrees), &told);
    assert!((recording.measured.tracks[0].position()[49] - measurement(49)[0]).abs() < 1e-12);
    assert_eq!(count(&recording.remarks, Code::LooksLikeDegrees), 0);
}

#[test]
fn a_frozen_sensor_is_noticed() {
    let recording = read(&log_of(|k| (NAMES.to_vec(), vec![measurement(k)[0], measurement(k.min(10))[1]])));
    assert_eq!(count(&recording.remarks, Code::FrozenSensor), 40);
}

#[test]
fn a_wrap_is_undone_for_joints_declared_continuous_only() {
    let wrapped = |k: i64| {
        let turn = std::f64::consts::TAU;
        (NAMES.to_vec(), vec![(0.2 * k as f64).rem_euclid(turn), measurement(k)[1]])
    };
    let recording = read(&log_of(wrapped));
    assert_eq!(count(&recording.remarks, Code::Wrapped), 1);
    let told = ReadOptions { continuous: vec!["a".into()], ..ReadOptions::default() };
    let recording = read_with(&log_of(wrapped), &told);
    assert_eq!(count(&recording.remarks, Code::Wrapped), 0);
    let q = recording.measured.tracks[0].position();
    // At the turn of the plan for most of the run.
    assert!((q[49] - q[0] - 9.8).abs() < 1e-9 && (q[0] + std::f64::consts::TAU).abs() < 1e-9);
    let described = ReadOptions {
        description: Some(
            "<robot name='r'><link name='base'/><link name='tower'/><joint name='a' type='continuous'>\
             <parent link='base'/><child link='tower'/></joint></robot>"
                .into(),
        ),
        ..ReadOptions::default()
    };
    let of_urdf = read_with(&log_of(wrapped), &described);
    assert_eq!((of_urdf.measured, of_urdf.remarks), (recording.measured, recording.remarks));
}

#[test]
fn a_planned_joint_that_nobody_measures_is_said_and_an_idle_one_is_not() {
    let recording = read(&log_of(|k| (vec!["b", "wheel"], vec![measurement(k)[1], 0.0])));
    let said: Vec<&str> = recording
        .remarks
        .as_slice()
        .iter()
        .filter(|remark| remark.code == Code::UnpairedJoint)
        .map(|remark| remark.message.as_str())
        .collect();
    assert_eq!(said, ["a is planned but was not measured; left out"]);
}

#[test]
fn pauses_and_slow_stretches_are_counted() {
    let mut log = Log::default();
    let schema = schema::controller_state(&["reference", "feedback", "error", "output"], true, true);
    let channel = Channel::cdr("/arm/controller_state", "control_msgs/msg/JointTrajectoryControllerState");
    log.add(channel.with_schema("ros2msg", schema), 0..SAMPLES, |k| {
        let factor = match k {
            10..15 => 0.0,
            15..18 => 0.5,
            _ => 1.0,
        };
        let points = [plan(k), measurement(k), vec![], vec![]].map(|q| encode::Point::at(&q));
        encode::controller_state(Kind::LittleEndian, stamp(k), &NAMES, &points, true, Some(factor))
    });
    let counts: Vec<u64> =
        read(&log).remarks.as_slice().iter().filter(|r| r.code == Code::Paused).map(|r| r.count).collect();
    assert_eq!(counts, [5, 3]);
}

#[test]
fn messages_that_do_not_fit_are_skipped_and_the_first_is_explained() {
    let mut log = log_of(|k| (NAMES.to_vec(), measurement(k)));
    for k in [60, 70, 80] {
        log.messages[k].data.truncate(40);
    }
    log.messages[90].data[1] = 0x77;
    log.messages[95].data.clear();
    let recording = read(&log);
    assert_eq!(recording.measured.tracks[0].len(), 45);
    assert_eq!(codes(&recording.remarks), [Code::UndecodableMessage]);
    assert_eq!(recording.remarks.as_slice()[0].count, 5);
    assert!(
        recording.remarks.as_slice()[0].message.contains("message ends at byte"),
        "{:?}",
        recording.remarks
    );
}

#[test]
fn where_joints_lie_in_an_encoding_that_is_not_read_the_error_says_so() {
    for (type_name, named) in [("", "no type"), ("foxglove.JointStates", "foxglove.JointStates")] {
        let mut log = Log::default();
        let channel = Channel::cdr("/arm", type_name).with_schema("", "").encoded("cbor");
        log.add(channel, 0..1, |_| vec![0; 9]);
        let why = "its messages are encoded as \"cbor\", which is not read";
        let found = error(&log, &ReadOptions::default());
        assert!(found.contains(&format!("/arm ({named}, 1 message, {why}")), "{found}");
        let found = error(&log, &options(&["/arm:q_des"], &["/arm:q"], &[]));
        assert!(found.contains(why), "{found}");
    }
}

#[test]
fn what_a_broken_message_said_of_joints_does_not_count() {
    let mut log = log_of(|k| {
        if k == 20 { (vec!["phantom", "a"], vec![1.0, 2.0]) } else { (NAMES.to_vec(), measurement(k)) }
    });
    let broken = &mut log.messages[(SAMPLES + 20) as usize].data;
    broken.truncate(broken.len() - 20);
    let recording = read(&log);
    assert_eq!(codes(&recording.remarks), [Code::UndecodableMessage]);
    let survey = survey_bytes(&log.bytes(mcap::WriteOptions::new()));
    let topic = survey.topics.iter().find(|topic| topic.topic == "/joint_states").unwrap();
    assert_eq!(topic.joints, NAMES);
}

#[test]
fn a_broken_schema_costs_its_channel_and_says_why() {
    let mut log = log_of(|k| (NAMES.to_vec(), measurement(k)));
    let odd = log.channel(Channel::states("/odd").with_schema("ros2msg", "float64[ x\n"));
    let idl = log.channel(Channel::states("/idl").with_schema("omgidl", "float64 x\n"));
    let secret = log.channel(Channel::states("/secret").encoded("xml"));
    for channel in [odd, odd, idl, secret] {
        log.send(channel, stamp(5), vec![0; 9]);
    }
    let recording = read(&log);
    assert_values(&recording.measured, measurement);
    let said: Vec<(u64, &str)> =
        recording.remarks.as_slice().iter().map(|remark| (remark.count, remark.message.as_str())).collect();
    assert_eq!(codes(&recording.remarks), [Code::UnreadableSchema; 3], "{said:?}");
    assert_eq!(said[0].0, 2);
    assert!(said[0].1.contains("/odd") && said[0].1.contains("float64[ x"), "{said:?}");
    assert!(said[1].1.contains("omgidl") && said[2].1.contains("xml"), "{said:?}");
}

#[test]
fn names_that_change_from_chunk_to_chunk_are_counted_too() {
    let order = |k: i64| match k % 2 {
        0 => (vec!["a", "b"], measurement(k)),
        _ => (vec!["b", "a"], measurement(k).into_iter().rev().collect()),
    };
    for per_chunk in [1, 7, 1000] {
        let recording =
            read_bytes(&log_of(order).by_hand("zstd", per_chunk), &ReadOptions::default()).unwrap();
        assert_eq!(count(&recording.remarks, Code::JointsChange), 49, "{per_chunk} messages a chunk");
    }
}

#[test]
fn naming_joints_to_read_makes_no_change_of_joints() {
    let log = log_of(|k| (vec!["b", "a", "wheel"], vec![measurement(k)[1], measurement(k)[0], 0.0]));
    let recording = read_bytes(&log.by_hand("", 10), &options(&[], &[], &NAMES)).unwrap();
    assert_eq!(count(&recording.remarks, Code::JointsChange), 0, "{:?}", recording.remarks);
    assert_values(&recording.measured, measurement);
}

#[test]
fn one_broken_schema_of_a_split_recording_is_said() {
    let whole = log_of(|k| (NAMES.to_vec(), measurement(k)));
    let (mut first, mut second) = (whole.clone(), whole);
    first.messages.retain(|message| message.log_ns < stamp(30) as u64);
    second.messages.retain(|message| message.log_ns >= stamp(30) as u64);
    second.channels[1] = second.channels[1].clone().with_schema("ros2msg", "float64[ x");
    let options = mcap::WriteOptions::new;
    let stored = file::store(&[("0.mcap", &first.bytes(options())), ("1.mcap", &second.bytes(options()))]);
    let recording = hydrotrace::log::read_recording(&stored.paths, &ReadOptions::default()).unwrap();
    assert_eq!(recording.measured.tracks[0].len(), 30);
    assert_eq!(count(&recording.remarks, Code::UnreadableSchema), 20, "{:?}", recording.remarks);
}

#[test]
fn one_sample_far_off_between_calm_neighbours_is_dropped_and_counted() {
    for off_rad in [1.0, -2.0, 0.7] {
        let mut log = Log::of_plan();
        let spoilt = move |k: i64| {
            let mut values = measurement(k);
            values[0] += if k == 20 { off_rad } else { 0.0 };
            values
        };
        add_joint_state(&mut log, "/joint_states", spoilt);
        let recording = read(&log);
        assert_eq!(count(&recording.remarks, Code::Implausible), 1, "{off_rad}");
        let track = recording.measured.track("a").unwrap();
        assert_eq!((track.len(), recording.measured.track("b").unwrap().len()), (49, 50));
        assert!(track.position().windows(2).all(|pair| (pair[1] - pair[0]).abs() < 0.2), "{off_rad}");
    }
}

#[test]
fn a_plan_that_jumps_is_said_to() {
    let mut log = Log::default();
    let jumps = |k: i64| {
        let mut values = plan(k);
        values[1] += if k >= 30 { 0.96 } else { 0.0 };
        values
    };
    add_joint_state(&mut log, "/planned/joint_states", jumps);
    add_joint_state(&mut log, "/joint_states", measurement);
    let recording = read(&log);
    let remark = recording.remarks.as_slice().iter().find(|remark| remark.code == Code::PlanJumps).unwrap();
    assert_eq!(remark.count, 1);
    assert!(remark.message.contains("the plan of b") && remark.message.contains("0.60 s"), "{remark:?}");
    assert_eq!(recording.planned.track("b").unwrap().len(), 50, "a step is no spike");
}
