//! Which topics are used, and what is said where that fails.

use super::{file::store, *};

#[test]
fn the_plan_is_found_by_name_and_commands_are_no_measurement() {
    let mut log = plain_log();
    add_joint_state(&mut log, "/command/joint_states", |k| vec![3.0 + k as f64, 6.0]);
    let recording = read(&log);
    assert_eq!(recording.source.planned_topic, "/planned/joint_states");
    assert_eq!(recording.source.measured_topic, "/joint_states");
    let recording =
        read_with(&log, &options(&["/command/joint_states:position"], &["/planned/joint_states"], &[]));
    assert_eq!(recording.source.planned_topic, "/command/joint_states");
    assert_eq!(recording.planned.tracks[0].position()[0], 3.0);
}

#[test]
fn joints_that_topics_of_another_kind_plan_belong_to_the_run_too() {
    let mut log = plain_log();
    let grip = |k| states(k, &["c"], &[1e-3 * k as f64]);
    log.add(Channel::states("/grip/joint_states"), 0..SAMPLES, grip);
    let channel = Channel::cdr("/grip/joint_trajectory", "trajectory_msgs/msg/JointTrajectory");
    let points = [encode::Point::at(&[0.2])];
    log.add(channel, 1..2, |k| encode::trajectory(cdr::Kind::LittleEndian, stamp(k), &["c"], &points));
    let recording = read(&log);
    let mut planned = joints(&recording.planned);
    planned.sort_unstable();
    assert_eq!(planned, ["a", "b", "c"]);
    assert!(joints(&recording.measured).contains(&"c"));
}

#[test]
fn joints_are_kept_in_the_order_of_the_caller() {
    let recording = read_with(&plain_log(), &options(&[], &[], &["b", "a"]));
    assert_eq!((joints(&recording.planned), joints(&recording.measured)), (vec!["b", "a"], vec!["b", "a"]));
}

#[test]
fn errors_name_what_was_found_expected_and_how_to_mend_it() {
    let log = plain_log();
    let topics = "/joint_states (sensor_msgs/msg/JointState, 50 messages)";
    let wrong_topic = error(&log, &options(&["/planed/joint_states"], &[], &[]));
    assert!(
        wrong_topic.starts_with(
            "no topic \"/planed/joint_states\", did you mean \"/planned/joint_states\"?; the log has "
        ),
        "{wrong_topic}"
    );
    assert!(wrong_topic.contains(topics), "{wrong_topic}");
    let wrong_field = error(&log, &options(&[], &["/joint_states:positions"], &[]));
    assert_eq!(
        wrong_field,
        "topic \"/joint_states\" (sensor_msgs/msg/JointState) has no joint angles in field \"positions\", did \
         you mean \"position\"?; it has position"
    );
    let wrong_joint = error(&log, &options(&[], &[], &["a", "bb"]));
    assert_eq!(wrong_joint, "no joint \"bb\", did you mean \"b\"?; the log has a, b");
    let mut no_plan = log.clone();
    no_plan.channels.remove(0);
    no_plan.messages.retain(|message| message.channel == 1);
    no_plan.messages.iter_mut().for_each(|message| message.channel = 0);
    let no_plan = error(&no_plan, &ReadOptions::default());
    let found = format!(
        "found no planned joint angles; the log has {topics}; name them with --planned TOPIC[:FIELD]; or, if they are in a log of their own, \
         `hydrotrace join "
    );
    assert!(
        no_plan.starts_with(&found) && no_plan.ends_with("whole.mcap` makes one log of both"),
        "{no_plan}"
    );
    let mut strangers = Log::of_plan();
    strangers.add(Channel::states("/joint_states"), 0..1, |k| states(k, &["x"], &[0.0]));
    let strangers = error(&strangers, &ReadOptions::default());
    assert!(
        strangers.starts_with("planned joints (a, b) and measured joints (x) have no name in common; choose"),
        "{strangers}"
    );
    // By name each would have the plan of its neighbour.
    let mut apart = Log::default();
    for (topic, first) in [("/planned_joint_states", 0), ("/joint_states", 1)] {
        let names = [first, first + 1, first + 2].map(|k| format!("joint_{k}"));
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        apart.add(Channel::states(topic), 0..SAMPLES, |k| states(k, &names, &[0.1, 0.2, 0.3]));
    }
    let said = error(&apart, &ReadOptions::default());
    assert!(
        said.contains("counted from different numbers") && said.ends_with("--joints joint_1,joint_2"),
        "{said}"
    );
    assert_eq!(
        joints(&read_with(&apart, &options(&[], &[], &["joint_1", "joint_2"])).planned),
        ["joint_1", "joint_2"]
    );
    // Which number is which joint nobody says.
    for order in [[0, 1], [1, 0]] {
        let mut nameless = Log::default();
        let came = |k| states(k, &["a", "b"], &measurement(k));
        nameless.add(Channel::states("/joint_states"), 0..4 * SAMPLES, came);
        let channel = Channel::cdr("/forward_position_controller/commands", "std_msgs/msg/Float64MultiArray");
        let sent = |k| encode::array(cdr::Kind::LittleEndian, &order.map(|joint| plan(k)[joint]));
        nameless.add(channel, 0..4 * SAMPLES, sent);
        nameless.messages.sort_by_key(|message| message.log_ns);
        let said = error(&nameless, &ReadOptions::default());
        assert!(said.contains("--joints=JOINT,JOINT,...;"), "{said}");
    }
}

#[test]
fn of_two_topics_whose_names_tell_nothing_the_other_is_the_other_side() {
    let mut log = Log::default();
    add_joint_state(&mut log, "/arm/generator", plan);
    add_joint_state(&mut log, "/arm/encoders", measurement);
    for (named, guesses) in [
        (options(&["/arm/generator"], &[], &[]), vec![]),
        (options(&[], &["/arm/encoders"], &[]), vec![Code::Guessed]),
        (options(&["/arm/generator"], &["/arm/encoders"], &[]), vec![]),
    ] {
        let recording = read_with(&log, &named);
        assert_usual(&recording);
        assert_eq!(codes(&recording.remarks), guesses);
    }
    add_joint_state(&mut log, "/arm/other", measurement);
    let found = error(&log, &options(&[], &["/arm/encoders"], &[]));
    assert!(found.starts_with("found no planned joint angles"), "{found}");
    log.channels.truncate(1);
    log.messages.retain(|message| message.channel == 0);
    let found = error(&log, &options(&["/arm/generator"], &[], &[]));
    assert!(found.starts_with("found no measured joint angles"), "{found}");
}

#[test]
fn joints_with_a_prefix_on_one_side_are_paired_and_that_is_said() {
    let mut log = Log::of_plan();
    let prefixed = |k| states(k, &["ex1/a", "ex1_b_joint"], &measurement(k));
    log.add(Channel::states("/joint_states"), 0..SAMPLES, prefixed);
    for names in [&[][..], &["a", "b"], &["ex1/a", "ex1_b_joint"]] {
        let recording = read_with(&log, &options(&[], &[], names));
        assert_usual(&recording);
        let remarks = recording.remarks.as_slice();
        assert_eq!(codes(&recording.remarks), [Code::Guessed]);
        assert!(remarks[0].message.contains("a with ex1/a, b with ex1_b_joint"), "{remarks:?}");
    }
}

#[test]
fn files_that_are_no_log_say_what_they_are() {
    for (bytes, found, fix) in [
        (&b"#ROSBAG V2.0\n"[..], "23 52 4F 53 42 41 47 20", "rosbags-convert"),
        (b"MDF     4.10", "4D 44 46 20 20 20 20 20", "asammdf"),
        (b"ULog\x01\x12\x35\x01", "55 4C 6F 67 01 12 35 01", "ulog2csv"),
        (b"PK\x03\x04\x14\0\x06\0", "50 4B 03 04 14 00 06 00", "save the sheet as CSV"),
        (b"MATLAB 5.0 MAT-file, Platform", "4D 41 54 4C 41 42 20 35", "writetable"),
        (b"TDSm\x0e\0\0\0", "54 44 53 6D 0E 00 00 00", "npTDMS"),
        (b"time;a;b\n0;1;2\n", "74 69 6D 65 3B 61 3B 62", "give an .mcap recording"),
    ] {
        let message = read_bytes(bytes, &ReadOptions::default()).unwrap_err().to_string();
        assert!(
            message.contains(&format!("found {found}, expected the bytes 89 4D 43 41 50 30 0D 0A")),
            "{message}"
        );
        assert!(message.contains(fix) && message.contains("run.mcap"), "{message}");
    }
    let empty = read_bytes(b"", &ReadOptions::default()).unwrap_err().to_string();
    assert!(empty.ends_with("run.mcap is empty: no log and no table is in it"), "{empty}");
    let missing =
        hydrotrace::log::read_recording(&[path("no/such.mcap")], &ReadOptions::default()).unwrap_err();
    assert_eq!(missing.to_string(), "cannot open no/such.mcap");
    assert!(std::error::Error::source(&missing).is_some());
    let empty = store(&[]);
    let empty = hydrotrace::log::read_recording(&[empty.folder.path().to_owned()], &ReadOptions::default())
        .unwrap_err();
    assert!(empty.to_string().contains("holds no .mcap or .db3 file; give a recording"), "{empty}");
}

#[test]
fn a_survey_lists_all_topics_with_rates_fields_and_joints() {
    let mut log = plain_log();
    let other = log.channel(
        file::Channel::cdr("/rosout", "std_msgs/msg/String").with_schema("ros2msg", "string data\n"),
    );
    log.send(other, stamp(3), vec![0, 1, 0, 0, 1, 0, 0, 0, 0]);
    let survey = survey_bytes(&log.bytes(mcap::WriteOptions::new()));
    let names: Vec<&str> = survey.topics.iter().map(|topic| topic.topic.as_str()).collect();
    assert_eq!(names, ["/joint_states", "/planned/joint_states", "/rosout"]);
    let topic = &survey.topics[0];
    assert!((topic.rate_hz - 50.0).abs() < 1e-9);
    assert_eq!(
        (topic.messages, &topic.joint_fields[..], &topic.joints[..]),
        (50, &["position".to_owned()][..], &NAMES.map(str::to_owned)[..])
    );
    assert_eq!(survey.recording.unwrap(), read(&log));
}
