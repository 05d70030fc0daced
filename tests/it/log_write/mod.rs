//! What `LogWriter` promises, checked with the crate `mcap` and a decoder of our own.

pub(crate) mod decode;
mod kill;
mod peers;
mod robot;

use std::{collections::BTreeMap, io::Write};

use hydrotrace::log::{ControllerState, LogWriter, Point, Role, Topics, Transform, WriteError, WriteOptions};
use mcap::{Message, MessageStream, Summary};
use proptest::prelude::*;

use decode::decode;

const JOINTS: [&str; 3] = ["swing", "boom", "stick é"];
const START_NS: i64 = 1_700_000_000_250_000_000;

/// A run of every kind of message, metadata and attachment.
fn write_run<W: Write>(log: &mut LogWriter<W>, samples: i64) {
    let task = BTreeMap::from([("task".to_owned(), "reach".to_owned())]);
    log.metadata("provenance", &task).unwrap();
    log.attach("task.json", "application/json", b"{}", START_NS).unwrap();
    log.description(Role::Measured, START_NS, "<robot/>").unwrap();
    log.description(Role::Planned, START_NS, "<robot name='é'/>").unwrap();
    let standing = Transform {
        parent: "base",
        child: "plan of base",
        translation_m: [0.0, 0.0, 1.0],
        rotation_xyzw: [0.0, 0.0, 0.0, 1.0],
    };
    log.fixed_transforms(START_NS, &[standing]).unwrap();
    let points = [0, 2_000_000_000].map(|time_from_start_ns| Point {
        position_rad: &[0.0, 1.0, 2.0],
        time_from_start_ns,
        ..Point::default()
    });
    log.trajectory(START_NS, &points).unwrap();
    for k in 0..samples {
        let stamp_ns = START_NS + k * 20_000_000;
        let planned = [0.1 * k as f64, 1.0, -1.0];
        let measured = [0.1 * k as f64 - 0.01, f64::NAN, -1.0 + 1e-3 * (k % 7) as f64];
        let velocity = [5.0, 0.0, -0.0];
        log.joint_sample(Role::Planned, stamp_ns, &planned, &velocity, &[]).unwrap();
        log.joint_sample(Role::Measured, stamp_ns, &measured, &[], &[1e4, 0.0, 5e3]).unwrap();
        log.joint_sample(Role::Command, stamp_ns, &[], &velocity, &[]).unwrap();
        let state = ControllerState {
            reference: Point { position_rad: &planned, velocity_rad_s: &velocity, ..Point::default() },
            feedback: Point { position_rad: &measured, ..Point::default() },
            output: Point { effort_n_m: &[1.0, 2.0, 3.0], ..Point::default() },
            speed_scaling_factor: 0.5,
        };
        log.controller_state(stamp_ns, &state).unwrap();
        let moving = Transform { child: "boom", rotation_xyzw: [0.6, 0.0, 0.0, 0.8], ..standing };
        log.transforms(stamp_ns, &[moving, Transform { parent: "boom", child: "é", ..moving }]).unwrap();
        log.tracking_error(stamp_ns, &[0.01, f64::NAN, 0.0]).unwrap();
    }
}

fn run(samples: i64, options: WriteOptions) -> Vec<u8> {
    let mut log = LogWriter::new(Vec::new(), &JOINTS, options).unwrap();
    write_run(&mut log, samples);
    log.finish().unwrap()
}

fn messages(bytes: &[u8]) -> Vec<Message<'_>> {
    MessageStream::new(bytes).unwrap().collect::<Result<_, _>>().unwrap()
}

fn on_topic<'a>(messages: &'a [Message<'a>], topic: &str) -> Vec<&'a Message<'a>> {
    messages.iter().filter(|message| message.channel.topic == topic).collect()
}

#[test]
fn equal_calls_give_equal_bytes() {
    let options = || WriteOptions { chunk_bytes: 4096, ..WriteOptions::live() };
    assert!(run(200, options()) == run(200, options()));
}

#[test]
fn every_sample_reads_back_bit_by_bit() {
    let bytes = run(5, WriteOptions::default());
    let messages = messages(&bytes);
    assert_eq!(messages.len(), 4 + 6 * 5);
    for (k, message) in on_topic(&messages, "/joint_states").into_iter().enumerate() {
        let value = decode(message);
        let stamp_ns = START_NS + 20_000_000 * i64::try_from(k).unwrap();
        assert_eq!(value.at("header.stamp").time_ns(), stamp_ns);
        assert_eq!((message.log_time, message.publish_time), (stamp_ns as u64, stamp_ns as u64));
        assert_eq!(message.sequence, k as u32);
        assert_eq!(value.at("header.frame_id").text(), "");
        assert_eq!(value.at("name").texts(), JOINTS);
        let position = value.at("position").numbers();
        assert_eq!(position[0].to_bits(), (0.1 * k as f64 - 0.01).to_bits());
        assert!(position[1].is_nan());
        assert!(value.at("velocity").list().is_empty());
        assert_eq!(value.at("effort").numbers(), [1e4, 0.0, 5e3]);
    }
}

#[test]
fn the_error_is_reference_minus_feedback_where_both_are_given() {
    let bytes = run(3, WriteOptions::default());
    let messages = messages(&bytes);
    let states = on_topic(&messages, "/arm_controller/controller_state");
    assert_eq!(states.len(), 3);
    let value = decode(states[2]);
    let error = value.at("error.positions").numbers();
    assert_eq!(error[0].to_bits(), (0.2_f64 - (0.2 - 0.01)).to_bits());
    assert!(error[1].is_nan());
    assert!(value.at("error.velocities").list().is_empty());
    assert_eq!(value.at("reference.velocities").numbers(), [5.0, 0.0, -0.0]);
    assert_eq!(value.at("output.effort").numbers(), [1.0, 2.0, 3.0]);
    assert!((value.at("speed_scaling_factor").number() - 0.5).abs() < f64::EPSILON);
    assert!(value.at("multi_dof_joint_names").list().is_empty());
    assert!(value.at("multi_dof_output.transforms").list().is_empty());
}

#[test]
fn a_plan_is_one_message() {
    let bytes = run(1, WriteOptions::default());
    let messages = messages(&bytes);
    let value = decode(on_topic(&messages, "/arm_controller/joint_trajectory")[0]);
    let points = value.at("points").list();
    assert_eq!(points.len(), 2);
    assert_eq!(points[1].at("positions").numbers(), [0.0, 1.0, 2.0]);
    assert_eq!(points[1].at("time_from_start").time_ns(), 2_000_000_000);
}

#[test]
fn quantities_of_joints_are_kept_by_joint_and_name() {
    let mut log = LogWriter::new(Vec::new(), &JOINTS, WriteOptions::default()).unwrap();
    let values: [(&str, &[f64]); 2] = [("pressure_pa", &[1e6, 2e6, 3e6]), ("spool", &[0.0, -0.5, f64::NAN])];
    log.interfaces(START_NS, &values).unwrap();
    let short = log.interfaces(START_NS, &[("spool", &[0.0])]).unwrap_err();
    assert_eq!(short.to_string(), "1 values of interface for 3 joints");
    assert!(matches!(log.interfaces(START_NS, &[("", &[0.0; 3])]), Err(WriteError::Interface { .. })));
    let bytes = log.finish().unwrap();
    let messages = messages(&bytes);
    let value = decode(on_topic(&messages, "/dynamic_joint_states")[0]);
    assert_eq!(value.at("joint_names").texts(), JOINTS);
    let joints = value.at("interface_values").list();
    assert_eq!(joints.len(), 3);
    assert_eq!(joints[1].at("interface_names").texts(), ["pressure_pa", "spool"]);
    assert_eq!(joints[1].at("values").numbers(), [2e6, -0.5]);
    assert!(joints[2].at("values").numbers()[1].is_nan());
}

#[test]
fn a_log_names_its_profile_library_types_and_quality_of_service() {
    let bytes = run(400, WriteOptions { chunk_bytes: 1 << 14, ..WriteOptions::default() });
    let header = mcap::read::LinearReader::new(&bytes).unwrap().next().unwrap().unwrap();
    let mcap::records::Record::Header(header) = header else { panic!("{header:?}") };
    assert_eq!(header.profile, "ros2");
    assert_eq!(header.library, concat!("hydrotrace ", env!("CARGO_PKG_VERSION")));
    let summary = Summary::read(&bytes).unwrap().unwrap();
    let statistics = summary.stats.unwrap();
    assert_eq!(statistics.message_count, 4 + 6 * 400);
    assert_eq!((statistics.attachment_count, statistics.metadata_count), (1, 1));
    assert_eq!(summary.attachment_indexes[0].name, "task.json");
    assert_eq!(summary.metadata_indexes[0].name, "provenance");
    assert!(summary.chunk_indexes.len() > 3);
    assert!(summary.chunk_indexes.iter().all(|chunk| chunk.compression == "zstd"));
    assert_eq!(summary.channels.len(), 10);
    for id in 1..=10 {
        let channel = &summary.channels[&id];
        let schema = channel.schema.as_ref().unwrap();
        assert_eq!(schema.name.split('/').nth(1), Some("msg"));
        let lines: Vec<&str> = channel.metadata["offered_qos_profiles"].lines().collect();
        assert_eq!(lines[0], "- history: 1");
        assert!(channel.metadata["topic_type_hash"].starts_with("RIHS01_"));
    }
}

#[test]
fn topics_can_be_renamed_but_not_shared() {
    let topics = || Topics { measured: "/excavator/joint_states".into(), ..Topics::default() };
    let bytes = run(1, WriteOptions { topics: topics(), ..WriteOptions::default() });
    assert_eq!(on_topic(&messages(&bytes), "/excavator/joint_states").len(), 1);
    let topics = Topics { planned: "/excavator/joint_states".into(), ..topics() };
    let shared = LogWriter::new(Vec::new(), &JOINTS, WriteOptions { topics, ..WriteOptions::default() });
    assert_eq!(shared.err().unwrap().to_string(), "topic /excavator/joint_states is given twice");
}

#[test]
fn what_no_reader_could_understand_is_refused_and_the_log_goes_on() {
    let refused = |names: &[&str]| LogWriter::new(Vec::new(), names, WriteOptions::default()).err().unwrap();
    assert!(matches!(refused(&[]), WriteError::NoJoints));
    assert!(matches!(refused(&["a", "b\0"]), WriteError::BadJointName { index: 1, .. }));
    assert!(matches!(refused(&["a", "b", "a"]), WriteError::Duplicate { kind: "joint", .. }));

    let mut log = LogWriter::new(Vec::new(), &JOINTS, WriteOptions::default()).unwrap();
    let short = log.joint_sample(Role::Measured, START_NS, &[0.0; 3], &[0.0; 2], &[]).unwrap_err();
    assert_eq!(short.to_string(), "2 values of velocity for 3 joints");
    let early = log.joint_sample(Role::Measured, -5, &[0.0; 3], &[], &[]).unwrap_err();
    assert!(matches!(early, WriteError::TimeRange { quantity: "stamp", value_ns: -5 }));
    let long = Point { time_from_start_ns: i64::MAX, ..Point::default() };
    let long = log.trajectory(START_NS, &[long]).unwrap_err();
    assert!(matches!(long, WriteError::TimeRange { quantity: "time from start", .. }));
    let standing = log.trajectory(START_NS, &[Point::default(); 2]).unwrap_err();
    assert!(matches!(standing, WriteError::NotIncreasing { index: 1, previous_ns: 0, next_ns: 0 }));
    log.joint_sample(Role::Measured, START_NS, &[0.0; 3], &[], &[]).unwrap();
    assert_eq!(messages(&log.finish().unwrap()).len(), 1);
}

#[test]
fn a_live_log_does_not_replace_an_existing_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let mut log = LogWriter::create(&path, &JOINTS, WriteOptions::live()).unwrap();
    write_run(&mut log, 3);
    log.finish().unwrap();
    assert!(matches!(
        LogWriter::create(&path, &JOINTS, WriteOptions::live()),
        Err(WriteError::Create { .. })
    ));
    assert_eq!(messages(&std::fs::read(&path).unwrap()).len(), 22);
}

proptest! {
    #[test]
    fn any_sample_of_any_joints_survives_the_round_trip(
        names in prop::collection::btree_set("[^\0]{1,12}", 1..9),
        stamp_ns in 0..i64::from(i32::MAX) * 1_000_000_000,
        given in prop::array::uniform3(any::<bool>()),
        seed in prop::collection::vec(any::<f64>(), 24),
    ) {
        let names: Vec<String> = names.into_iter().collect();
        let quantity = |k: usize| if given[k] { &seed[k * 8..k * 8 + names.len()] } else { &[] };
        let mut log = LogWriter::new(Vec::new(), &names, WriteOptions::default()).unwrap();
        log.joint_sample(Role::Planned, stamp_ns, quantity(0), quantity(1), quantity(2)).unwrap();
        let bytes = log.finish().unwrap();
        let value = decode(&messages(&bytes)[0]);
        prop_assert_eq!(value.at("name").texts(), names.clone());
        prop_assert_eq!(value.at("header.stamp").time_ns(), stamp_ns);
        for (k, field) in ["position", "velocity", "effort"].into_iter().enumerate() {
            let bits = |values: &[f64]| values.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
            prop_assert_eq!(bits(&value.at(field).numbers()), bits(quantity(k)));
        }
    }
}
