//! What is fed with broken inputs, by coverage (`fuzz_targets`) and by mutation (`bin/campaign.rs`).

pub mod log;
pub mod mutate;
pub mod seeds;

use std::{path::Path, sync::OnceLock};

use hydrotrace::{
    arm::{Arm, Chain, Hydraulics, sliding_joints},
    log::{CsvOptions, ReadOptions, read_csv_bytes, survey, survey_bytes},
    plant::Parameters,
    task::Task,
    workflow::fit::LimitsFile,
};

/// A name, what takes the bytes, and how many broken inputs of a thousand it is given by the campaign.
pub type Target = (&'static str, fn(&[u8]), usize);

/// All of them.
pub const TARGETS: [Target; 12] = [
    ("read_log", read_log, 290),
    ("forms", forms, 10),
    ("schema", schema, 100),
    ("cdr", cdr, 100),
    ("json", json, 60),
    ("protobuf", protobuf, 60),
    ("csv", csv, 140),
    ("task", task, 60),
    ("urdf", urdf, 60),
    ("hydraulics", hydraulics, 40),
    ("limits", limits, 40),
    ("plant", plant, 40),
];

/// Any bytes as a log.
pub fn read_log(bytes: &[u8]) {
    let _ = survey_bytes(bytes, &ReadOptions::default());
}

/// Any bytes as a file of any form: packed, a bag in SQLite, a table.
pub fn forms(bytes: &[u8]) {
    let path = std::env::temp_dir().join(format!("hydrotrace-fuzz-{}", std::process::id()));
    if std::fs::write(&path, bytes).is_ok() {
        let _ = survey(&[path], &ReadOptions::default());
    }
}

/// Any text as the definition of a message type, any bytes as its message: the first byte chooses the notation, a
/// zero byte ends the text.
pub fn schema(bytes: &[u8]) {
    let Some((&choice, rest)) = bytes.split_first() else { return };
    let end = rest.iter().position(|&byte| byte == 0).unwrap_or(rest.len());
    let (text, message) = (&rest[..end], rest.get(end + 1..).unwrap_or_default());
    let (name, notation, encoding) = log::NOTATIONS[usize::from(choice) % log::NOTATIONS.len()];
    // Descriptors may hold zeros: they go on to the end, and the messages are the same bytes.
    let text = if notation == "protobuf" { rest } else { text };
    read_log(&log::of(name, notation, text, encoding, message));
}

/// Any bytes as a message of a known type; the first byte chooses it.
pub fn cdr(bytes: &[u8]) {
    let Some((&choice, message)) = bytes.split_first() else { return };
    let (name, text) = &log::types()[usize::from(choice) % log::types().len()];
    read_log(&log::of(name, "ros2msg", text.as_bytes(), "cdr", message));
}

/// Any bytes as a message in JSON.
pub fn json(bytes: &[u8]) {
    read_log(&log::of("foxglove.JointStates", "jsonschema", b"{}", "json", bytes));
}

/// Any bytes as a message in Protobuf.
pub fn protobuf(bytes: &[u8]) {
    read_log(&log::of("foxglove.JointStates", "protobuf", &log::descriptor(), "protobuf", bytes));
}

/// Any bytes as a table.
pub fn csv(bytes: &[u8]) {
    let _ = read_csv_bytes("table.csv", bytes, &CsvOptions::default());
}

fn text(bytes: &[u8], take: impl FnOnce(&str)) {
    take(&String::from_utf8_lossy(bytes));
}

/// Any text as a task.
pub fn task(bytes: &[u8]) {
    text(bytes, |text| drop(Task::parse(text)));
}

/// Any text as a description of an arm, that of a log too.
pub fn urdf(bytes: &[u8]) {
    text(bytes, |text| {
        let _ = sliding_joints(text);
        if let Ok(chain) = Chain::from_urdf(text, "any.urdf", None) {
            let still = vec![0.0; chain.joint_count()];
            let _ = (chain.tool_pose(&still), chain.reach_m(), chain.shapes(&chain.meshes()));
        }
    });
}

/// Any text as the cylinders of the sample arm.
pub fn hydraulics(bytes: &[u8]) {
    static SAMPLE: OnceLock<Option<Arm>> = OnceLock::new();
    let Some(arm) = SAMPLE.get_or_init(|| Arm::sample().ok()) else { return };
    text(bytes, |text| drop(Hydraulics::from_toml(text, "any.toml", &arm.chain)));
}

/// Any text as a file of limits.
pub fn limits(bytes: &[u8]) {
    text(bytes, |text| drop(LimitsFile::parse(Path::new("any.toml"), text)));
}

/// Any text as a plant.
pub fn plant(bytes: &[u8]) {
    text(bytes, |text| drop(Parameters::parse(text)));
}
