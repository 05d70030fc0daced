//! Topics of samples other than controller states.

use super::{cdr::KINDS, encode, file::Channel, *};

#[test]
fn joints_are_joined_by_name_whatever_their_order_and_subset() {
    let mut log = Log::of_plan();
    log.add(Channel::states("/joint_states"), 0..SAMPLES, |k| {
        let q = measurement(k);
        let (names, values): (&[&str], Vec<f64>) = match k % 3 {
            0 => (&["a", "b"], vec![q[0], q[1]]),
            1 => (&["b", "other", "a"], vec![q[1], 7.0, q[0]]),
            _ => (&["b"], vec![q[1]]),
        };
        states(k, names, &values)
    });
    let recording = read(&log);
    let (a, b) = (recording.measured.track("a").unwrap(), recording.measured.track("b").unwrap());
    assert_eq!((a.len(), b.len()), (34, 50));
    for (&t_s, &q) in a.t_s().iter().zip(a.position()) {
        assert_eq!(q, measurement((t_s / 0.02).round() as i64)[0]);
    }
    for (k, &q) in b.position().iter().enumerate() {
        assert_eq!(q, measurement(k as i64)[1]);
    }
    assert_eq!(count(&recording.remarks, Code::JointsChange), 49);
}

/// A log of a plan, and of two publishers that send a joint each on one topic, the second `late_ns` after the first and
/// stamped `stamped_ns` after it.
fn two_publishers(late_ns: i64, stamped_ns: i64) -> Log {
    let mut log = Log::of_plan();
    let channel = log.channel(Channel::states("/joint_states"));
    for k in 0..SAMPLES {
        for (j, after_ns, own_ns) in [(0, 0, stamp(k)), (1, late_ns, stamp(k) + stamped_ns)] {
            let data = encode::joint_state(
                cdr::Kind::LittleEndian,
                own_ns,
                &NAMES[j..=j],
                &measurement(k)[j..=j],
                &[],
            );
            log.send(channel, stamp(k) + after_ns, data);
        }
    }
    log.messages.sort_by_key(|message| message.log_ns);
    log
}

#[test]
fn two_publishers_of_one_topic_are_each_judged_by_themselves() {
    for (late_ns, stamped_ns) in
        [(25_000_000, 0), (25_000_000, 1_300_000), (9_000_000, 0), (3_000_000, 2_000_000)]
    {
        let log = two_publishers(late_ns, stamped_ns);
        for options in [ReadOptions::default(), options(&[], &["/joint_states"], &[])] {
            let recording = read_with(&log, &options);
            assert!(recording.remarks.is_empty(), "{late_ns} {stamped_ns}: {:?}", recording.remarks);
            assert_eq!(recording.source.time_base, hydrotrace::log::TimeBase::Header);
            assert_eq!(
                (recording.source.measured_topic.as_str(), recording.source.messages),
                ("/joint_states", 100)
            );
            for (j, name) in NAMES.into_iter().enumerate() {
                let track = recording.measured.track(name).unwrap();
                assert_eq!(track.len() as i64, SAMPLES, "{late_ns} {stamped_ns} {name}");
                assert!((0..SAMPLES).all(|k| track.position()[k as usize] == measurement(k)[j]));
                assert!((track.t_s()[0] - j as f64 * stamped_ns as f64 * 1e-9).abs() < 1e-9, "{name}");
            }
        }
    }
}

#[test]
fn joint_states_in_every_encoding_with_velocities() {
    for kind in KINDS {
        let mut log = Log::default();
        log.add(Channel::states("/planned/joint_states"), 0..SAMPLES, |k| {
            encode::joint_state(kind, stamp(k), &NAMES, &plan(k), &[0.5, -1.0])
        });
        add_joint_state(&mut log, "/joint_states", measurement);
        let recording = read(&log);
        assert_values(&recording.planned, plan);
        assert_eq!(recording.planned.tracks[1].velocity(), Some(&[-1.0; 50][..]), "{kind:?}");
    }
}

#[test]
fn subsets_on_several_topics_are_put_together() {
    let mut log = Log::of_plan();
    for (j, topic) in ["/left/joint_states", "/right/joint_states"].into_iter().enumerate() {
        let one = |k| states(k, &NAMES[j..=j], &measurement(k)[j..=j]);
        log.add(Channel::states(topic), 0..SAMPLES, one);
    }
    let recording = read(&log);
    assert_values(&recording.measured, measurement);
    assert_eq!(recording.source.measured_topic, "/left/joint_states, /right/joint_states");
    assert!(recording.remarks.is_empty(), "{:?}", recording.remarks);
}

#[test]
fn the_plan_is_of_the_arm_whose_measurement_is_named() {
    let mut log = Log::default();
    let later = |q: Vec<f64>| q.iter().map(|q| q + 0.3).collect::<Vec<f64>>();
    add_joint_state(&mut log, "/left/planned/joint_states", plan);
    add_joint_state(&mut log, "/right/planned/joint_states", move |k| later(plan(k)));
    add_joint_state(&mut log, "/left/joint_states", measurement);
    add_joint_state(&mut log, "/right/joint_states", move |k| later(measurement(k)));
    for (arm, by) in [("left", 0.0), ("right", 0.3)] {
        let named = format!("/{arm}/joint_states");
        let recording = read_with(&log, &options(&[], &[&named], &[]));
        assert_eq!(recording.source.planned_topic, format!("/{arm}/planned/joint_states"));
        assert!((recording.planned.tracks[0].position()[0] - plan(0)[0] - by).abs() < 1e-12, "{arm}");
        assert!(recording.remarks.is_empty(), "{:?}", recording.remarks);
    }
    let mut log = Log::default();
    add_joint_state(&mut log, "/arm_right_planner/planned/joint_states", plan);
    add_joint_state(&mut log, "/arm_left/joint_states", measurement);
    add_joint_state(&mut log, "/arm_right/joint_states", measurement);
    assert_eq!(read(&log).source.measured_topic, "/arm_right/joint_states");
}

#[test]
fn dynamic_joint_states_yield_positions_and_other_interfaces_by_name() {
    for kind in KINDS {
        let mut log = Log::of_plan();
        let channel = Channel::cdr("/dynamic_joint_states", "control_msgs/msg/DynamicJointState");
        log.add(channel, 0..SAMPLES, |k| {
            let q = measurement(k);
            let joints: [(&str, &[(&str, f64)]); 4] = [
                ("tank", &[("pressure", 2e5)]),
                ("b", &[("pressure", 1e5), ("position", q[1])]),
                ("a", &[("position", q[0]), ("velocity", 0.5)]),
                ("gripper", &[]),
            ];
            encode::dynamic(kind, stamp(k), &joints)
        });
        let recording = read(&log);
        let [b, a] = &recording.measured.tracks[..] else { panic!("{:?}", joints(&recording.measured)) };
        assert_eq!((b.name(), a.name()), ("b", "a"));
        for k in 0..SAMPLES {
            assert_eq!([a.position()[k as usize], b.position()[k as usize]], measurement(k)[..]);
        }
        assert!(recording.remarks.is_empty(), "{kind:?} {:?}", recording.remarks);
        let pressure = read_with(&log, &options(&[], &["/dynamic_joint_states:pressure"], &["b"]));
        assert_eq!(pressure.measured.tracks[0].position()[0], 1e5);
    }
}

fn send_versioned(log: &mut Log, (names, values): (usize, usize), k: i64, spell: fn(&str) -> String) {
    let q: [Vec<f64>; 2] = [plan(k), measurement(k)];
    let version = 1 + (k / 20) as u32;
    let mut rows = [
        ("command_interface.a/position", q[0][0]),
        ("command_interface.b/position", q[0][1]),
        ("state_interface.a/position", q[1][0]),
        ("state_interface.b/position", q[1][1]),
        ("state_interface.b/effort", 5.0),
        ("controller_manager.cycle_time", 0.01),
    ];
    if version == 2 {
        rows.reverse();
    }
    let spelt: Vec<String> = rows.iter().map(|(name, _)| spell(name)).collect();
    if k % 20 == 0 {
        log.send(
            names,
            stamp(k),
            cdr::Cdr::message(cdr::Kind::LittleEndian, |cdr| {
                cdr.header(stamp(k));
                cdr.texts(&spelt.iter().map(String::as_str).collect::<Vec<_>>());
                cdr.u32(version);
            }),
        );
    }
    log.send(
        values,
        stamp(k),
        cdr::Cdr::message(cdr::Kind::LittleEndian, |cdr| {
            cdr.header(stamp(k));
            cdr.f64s(&rows.iter().map(|(_, value)| *value).collect::<Vec<_>>());
            cdr.u32(version);
        }),
    );
}

/// What is read of introspection whose names are spelt so.
fn versioned(spell: fn(&str) -> String) -> Recording {
    let mut recording = read(&introspection(spell));
    for series in [&mut recording.planned, &mut recording.measured] {
        series.tracks.sort_by(|a, b| a.name().cmp(b.name()));
    }
    recording
}

fn introspection(spell: fn(&str) -> String) -> Log {
    let mut log = Log::default();
    let stem = "/controller_manager/introspection_data";
    let names =
        log.channel(Channel::cdr(&format!("{stem}/names"), "pal_statistics_msgs/msg/StatisticsNames"));
    let values =
        log.channel(Channel::cdr(&format!("{stem}/values"), "pal_statistics_msgs/msg/StatisticsValues"));
    (0..SAMPLES).for_each(|k| send_versioned(&mut log, (names, values), k, spell));
    log
}

#[test]
fn introspection_values_are_joined_to_their_names_by_version() {
    let recording = versioned(str::to_owned);
    assert_usual(&recording);
    assert!(recording.remarks.is_empty(), "{:?}", recording.remarks);
}

#[test]
fn introspection_values_that_are_no_interfaces_are_told_by_the_words_of_their_names() {
    let recording = versioned(|name| {
        let (kind, joint) = name.split_once('.').unwrap();
        let (joint, quantity) = joint.rsplit_once('/').unwrap_or((joint, "cpu"));
        let side = if kind.starts_with("command") { "desired" } else { "actual" };
        format!("/arm_control_{side}_{quantity}_{joint}_link")
    });
    let at = |series: &Series| series.tracks.iter().map(|track| track.position()[7]).collect::<Vec<f64>>();
    assert_eq!([at(&recording.planned), at(&recording.measured)], [plan(7), measurement(7)]);
    assert_eq!(count(&recording.remarks, Code::Guessed), 1, "{:?}", recording.remarks);
}

#[test]
fn introspection_values_are_chosen_by_their_names() {
    let topic = "/controller_manager/introspection_data/values";
    let named = |names: [&str; 2]| names.map(|name| format!("{topic}:{name}"));
    let read = |log: &Log, plan: &[String], came: &[String]| {
        let [plan, came] = [plan, came].map(|all| all.iter().map(String::as_str).collect::<Vec<_>>());
        read_bytes(&log.bytes(mcap::WriteOptions::new()), &options(&plan, &came, &[]))
    };
    let at = |series: &Series| series.tracks.iter().map(|track| track.position()[7]).collect::<Vec<f64>>();
    let plain = introspection(str::to_owned);
    let names = named(["command_interface.b/position", "command_interface.a/position"]);
    let recording = read(&plain, &names, &[]).unwrap();
    assert_eq!([joints(&recording.planned), joints(&recording.measured)], [["b", "a"], ["a", "b"]]);
    assert_eq!(at(&recording.planned), [plan(7)[1], plan(7)[0]]);
    assert_eq!(recording.source.planned_field, "command_interface.b/position, command_interface.a/position");
    // Names that say neither plan nor measurement.
    let bare =
        introspection(|name| name.replace("command_interface", "in").replace("state_interface", "out"));
    let ins = named(["in.a/position", "in.b/position"]);
    let outs = named(["out.a/position", "out.b/position"]);
    let recording = read(&bare, &ins, &outs).unwrap();
    assert_eq!([at(&recording.planned), at(&recording.measured)], [plan(7), measurement(7)]);
    let error = read(&plain, &named(["command_interface.c/position", "x"]), &[]).unwrap_err().to_string();
    assert!(error.contains("did you mean") && error.contains("controller_manager.cycle_time"), "{error}");
}

#[test]
fn a_nameless_array_takes_its_joints_from_the_caller() {
    for kind in KINDS {
        let mut log = Log::default();
        let channel = Channel::cdr("/arm/commands", "std_msgs/msg/Float64MultiArray");
        log.add(channel, 0..SAMPLES, |k| encode::array(kind, &plan(k)));
        add_joint_state(&mut log, "/joint_states", measurement);
        let recording = read_with(&log, &options(&["/arm/commands"], &[], &NAMES));
        assert_usual(&recording);
        assert_eq!(recording.source.time_base, hydrotrace::log::TimeBase::Publish);
        assert_eq!(count(&recording.remarks, Code::JointsChange), 0, "{:?}", recording.remarks);
    }
}

#[test]
fn foxglove_joint_states_of_ros_are_read_in_every_encoding() {
    for kind in KINDS {
        let mut log = Log::of_plan();
        log.add(Channel::cdr("/joints", "foxglove_msgs/msg/JointStates"), 0..SAMPLES, |k| {
            let q = measurement(k);
            cdr::Cdr::message(kind, |cdr| {
                cdr.time(stamp(k));
                cdr.list(&[("a", q[0]), ("b", q[1])], |cdr, (name, position)| {
                    cdr.record(|cdr| {
                        cdr.text(name);
                        [*position, 0.0, 0.0, 0.0].iter().for_each(|v| cdr.f64(*v));
                    });
                });
            })
        });
        let recording = read(&log);
        assert_values(&recording.measured, measurement);
        assert_eq!(recording.source.time_base, hydrotrace::log::TimeBase::Header);
    }
}

#[test]
fn idl_says_the_same_as_msg() {
    let mut log = plain_log();
    for channel in &mut log.channels {
        *channel = channel.clone().with_schema("ros2idl", schema::joint_state_idl());
    }
    assert_eq!(read(&log), read(&plain_log()));
}

#[test]
fn crlf_comments_constants_and_bounds_in_a_schema_do_not_matter() {
    let mut log = plain_log();
    let own = "# note\r\nuint8 MODE=1 # one\r\nstring LABEL = \"a # b\"\r\nstd_msgs/Header header   # when\r\n\
               string<=32[<=64] name\r\nfloat64[] position\r\nfloat64[<=64] velocity\r\nfloat64[] effort\r\n";
    for channel in &mut log.channels {
        *channel = channel.clone().with_schema("ros2msg", schema::text_of("sensor_msgs/JointState", own));
    }
    assert_eq!(read(&log), read(&plain_log()));
}
