//! The arm in a log, for tools that draw: what they are told is where the joints say.

use std::collections::BTreeMap;

use hydrotrace::{
    arm::{Arm, Chain, GHOST, Pose},
    log::{LogError, LogWriter, ReadOptions, Role, WriteError, WriteOptions, read_plan, read_recording},
    workflow::carried::arm_log::ArmLog,
};
use nalgebra::{Quaternion, Translation3, UnitQuaternion};

use super::{
    START_NS,
    decode::{Value, decode},
    messages, on_topic,
};

const JOINTS: [&str; 6] = ["J1", "J2", "J3", "J4", "J5", "J6"];
const PLANNED_RAD: [f64; 6] = [1.0, 2.0, -0.5, 0.1, -0.1, 0.2];
const MEASURED_RAD: [f64; 6] = [0.9, 2.1, -0.45, 0.1, -0.12, 0.25];

fn chain() -> Chain {
    Arm::sample().unwrap().chain
}

/// A log of so many samples at 1 kHz, with the arm in it if `drawn`.
fn log(samples: i64, drawn: bool, ghost: bool) -> Vec<u8> {
    let chain = chain();
    let mut log = LogWriter::new(Vec::new(), &JOINTS, WriteOptions::default()).unwrap();
    let mut arm = drawn.then(|| ArmLog::begin(&mut log, &chain, &JOINTS, START_NS, ghost).unwrap().unwrap());
    for k in 0..samples {
        let stamp_ns = START_NS + k * 1_000_000;
        log.joint_sample(Role::Planned, stamp_ns, &PLANNED_RAD, &[], &[]).unwrap();
        log.joint_sample(Role::Measured, stamp_ns, &MEASURED_RAD, &[], &[]).unwrap();
        if let Some(arm) = &mut arm {
            log.tracking_error(stamp_ns, &[0.1; 6]).unwrap();
            arm.sample(&mut log, stamp_ns, &PLANNED_RAD, Some(&MEASURED_RAD)).unwrap();
        }
    }
    log.finish().unwrap()
}

/// The last place of every frame, by its name, seen from its parent.
fn frames(bytes: &[u8]) -> BTreeMap<String, (String, Pose)> {
    let messages = messages(bytes);
    let mut frames = BTreeMap::new();
    for message in [on_topic(&messages, "/tf_static"), on_topic(&messages, "/tf")].concat() {
        for transform in decode(message).at("transforms").list() {
            let [x, y, z] = ["x", "y", "z"].map(|axis| of(transform, "translation", axis));
            let [i, j, k, w] = ["x", "y", "z", "w"].map(|axis| of(transform, "rotation", axis));
            let rotation = UnitQuaternion::from_quaternion(Quaternion::new(w, i, j, k));
            let pose = Pose::from_parts(Translation3::new(x, y, z), rotation.to_rotation_matrix());
            let parent = transform.at("header.frame_id").text().to_owned();
            frames.insert(transform.at("child_frame_id").text().to_owned(), (parent, pose));
        }
    }
    frames
}

fn of(transform: &Value, part: &str, axis: &str) -> f64 {
    transform.at(&format!("transform.{part}.{axis}")).number()
}

fn place(frames: &BTreeMap<String, (String, Pose)>, link: &str) -> Pose {
    match frames.get(link) {
        Some((parent, pose)) => place(frames, parent) * pose,
        None => Pose::identity(),
    }
}

#[test]
fn every_link_is_where_the_joints_put_it_and_the_ghosts_where_the_plan_does() {
    let (chain, frames) = (chain(), frames(&log(30, true, true)));
    for (prefix, angles_rad) in [("", MEASURED_RAD), (GHOST, PLANNED_RAD)] {
        for (name, expected) in chain.link_names().zip(chain.link_poses(&angles_rad)) {
            let apart = expected.inv_mul(&place(&frames, &format!("{prefix}{name}")));
            assert!(apart.translation.vector.norm() < 1e-5, "{prefix}{name}: {apart}");
            assert!(apart.rotation.angle() < 1e-5, "{prefix}{name}: {apart}");
        }
    }
    assert_eq!(frames["planned/base"].0, "base", "both stand in one place");
}

#[test]
fn without_a_measurement_the_plan_moves_the_arm_and_there_is_no_ghost() {
    let chain = chain();
    let mut log = LogWriter::new(Vec::new(), &JOINTS, WriteOptions::default()).unwrap();
    let mut arm = ArmLog::begin(&mut log, &chain, &JOINTS, START_NS, false).unwrap().unwrap();
    arm.sample(&mut log, START_NS, &PLANNED_RAD, None).unwrap();
    let bytes = log.finish().unwrap();
    let frames = frames(&bytes);
    let tool = place(&frames, "tool");
    assert!((tool.translation.vector - chain.tool_pose(&PLANNED_RAD).translation.vector).norm() < 1e-5);
    assert!(frames.keys().all(|name| !name.starts_with(GHOST)));
    assert!(on_topic(&messages(&bytes), "/planned/robot_description").is_empty());
}

#[test]
fn links_are_placed_fifty_times_a_second_and_a_lost_sample_leaves_them() {
    assert_eq!(on_topic(&messages(&log(1000, true, true)), "/tf").len(), 50);
    let chain = chain();
    let mut log = LogWriter::new(Vec::new(), &JOINTS, WriteOptions::default()).unwrap();
    let mut arm = ArmLog::begin(&mut log, &chain, &JOINTS, START_NS, false).unwrap().unwrap();
    arm.sample(&mut log, START_NS, &PLANNED_RAD, Some(&[f64::NAN; 6])).unwrap();
    arm.sample(&mut log, START_NS + 1_000_000, &PLANNED_RAD, Some(&MEASURED_RAD)).unwrap();
    assert_eq!(on_topic(&messages(&log.finish().unwrap()), "/tf").len(), 1);
}

#[test]
fn the_descriptions_come_first_once_and_are_kept_for_those_who_come_late() {
    let bytes = log(100, true, true);
    let messages = messages(&bytes);
    for (k, topic) in ["/robot_description", "/planned/robot_description", "/tf_static"].iter().enumerate() {
        assert_eq!(messages[k].channel.topic, *topic);
        assert_eq!(on_topic(&messages, topic).len(), 1);
        assert!(messages[k].channel.metadata["offered_qos_profiles"].contains("durability: 1\n"));
    }
    let text = decode(&messages[0]);
    let read = Chain::from_urdf(text.at("data").text(), "described", Some("tool")).unwrap();
    for (a, b) in read.link_poses(&MEASURED_RAD).iter().zip(chain().link_poses(&MEASURED_RAD)) {
        assert!((a.translation.vector - b.translation.vector).norm() < 1e-9);
    }
}

#[test]
fn an_arm_with_a_joint_that_the_log_lacks_is_not_drawn() {
    let mut log = LogWriter::new(Vec::new(), &JOINTS[..5], WriteOptions::default()).unwrap();
    assert!(ArmLog::begin(&mut log, &chain(), &JOINTS[..5], START_NS, true).unwrap().is_none());
    assert!(messages(&log.finish().unwrap()).is_empty());
}

#[test]
fn nobody_takes_the_error_or_the_arm_for_a_plan_or_a_measurement() {
    let folder = tempfile::tempdir().unwrap();
    let read = |name: &str, bytes: Vec<u8>| {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        [path]
    };
    let options = ReadOptions::default();
    let with = read_recording(&read("with.mcap", log(200, true, true)), &options).unwrap();
    let without = read_recording(&read("without.mcap", log(200, false, false)), &options).unwrap();
    assert_eq!((&with.planned, &with.measured), (&without.planned, &without.measured));
    assert_eq!((&with.source, &with.remarks), (&without.source, &without.remarks));

    let error_beside = |role: Option<Role>| {
        let mut log = LogWriter::new(Vec::new(), &JOINTS, WriteOptions::default()).unwrap();
        for k in 0..100 {
            let stamp_ns = START_NS + k * 10_000_000;
            log.tracking_error(stamp_ns, &[0.1; 6]).unwrap();
            if let Some(role) = role {
                log.joint_sample(role, stamp_ns, &PLANNED_RAD, &[], &[]).unwrap();
            }
        }
        log.finish().unwrap()
    };
    let missing = |error: LogError| match error {
        LogError::Missing { missing, .. } => missing,
        other => panic!("{other}"),
    };
    let planned = read("planned.mcap", error_beside(Some(Role::Planned)));
    assert_eq!(missing(read_recording(&planned, &options).unwrap_err()), "measured");
    let measured = read("measured.mcap", error_beside(Some(Role::Measured)));
    assert_eq!(missing(read_recording(&measured, &options).unwrap_err()), "planned");
    let alone = read("alone.mcap", error_beside(None));
    assert_eq!(missing(read_plan(&alone, &options).unwrap_err()), "planned");
}

#[test]
fn texts_that_no_reader_could_give_back_are_refused() {
    let mut log = LogWriter::new(Vec::new(), &JOINTS, WriteOptions::default()).unwrap();
    assert!(matches!(log.description(Role::Measured, START_NS, ""), Err(WriteError::Text { .. })));
    assert!(matches!(log.description(Role::Measured, START_NS, "a\0b"), Err(WriteError::Text { .. })));
    let short = log.tracking_error(START_NS, &[0.0]).unwrap_err();
    assert_eq!(short.to_string(), "1 values of tracking error for 6 joints");
}
