//! Messages in Protobuf, with descriptors and values encoded here by hand.

use super::{file::Channel, *};

pub(crate) fn varint(mut value: u64) -> Vec<u8> {
    let mut bytes = Vec::new();
    while value > 0x7f {
        bytes.push(value as u8 | 0x80);
        value >>= 7;
    }
    bytes.push(value as u8);
    bytes
}

/// A field of length-delimited bytes.
pub(crate) fn nested(number: u64, bytes: &[u8]) -> Vec<u8> {
    [varint(number << 3 | 2), varint(bytes.len() as u64), bytes.to_vec()].concat()
}

pub(crate) fn integer(number: u64, value: u64) -> Vec<u8> {
    [varint(number << 3), varint(value)].concat()
}

pub(crate) fn double(number: u64, value: f64) -> Vec<u8> {
    [varint(number << 3 | 1), value.to_le_bytes().to_vec()].concat()
}

const DOUBLE: u64 = 1;
const INT64: u64 = 3;
const INT32: u64 = 5;
const TEXT: u64 = 9;
const MESSAGE: u64 = 11;

/// A `FieldDescriptorProto`.
pub(crate) fn field(name: &str, number: u64, repeated: bool, kind: u64, of: &str) -> Vec<u8> {
    let label = if repeated { 3 } else { 1 };
    let mut bytes =
        [nested(1, name.as_bytes()), integer(3, number), integer(4, label), integer(5, kind)].concat();
    if !of.is_empty() {
        bytes.extend(nested(6, of.as_bytes()));
    }
    bytes
}

/// A `DescriptorProto`.
pub(crate) fn message(name: &str, fields: &[Vec<u8>]) -> Vec<u8> {
    let fields: Vec<u8> = fields.iter().flat_map(|field| nested(2, field)).collect();
    [nested(1, name.as_bytes()), fields].concat()
}

/// A `FileDescriptorProto` in a set of its own.
pub(crate) fn descriptor_file(name: &str, package: &str, imports: &[&str], messages: &[Vec<u8>]) -> Vec<u8> {
    let mut bytes = [nested(1, name.as_bytes()), nested(2, package.as_bytes())].concat();
    bytes.extend(imports.iter().flat_map(|import| nested(3, import.as_bytes())));
    bytes.extend(messages.iter().flat_map(|message| nested(4, message)));
    bytes.extend(nested(12, b"proto3"));
    nested(1, &bytes)
}

/// The descriptors of `foxglove.JointStates`.
pub(crate) fn joint_states() -> Vec<u8> {
    let timestamp =
        message("Timestamp", &[field("seconds", 1, false, INT64, ""), field("nanos", 2, false, INT32, "")]);
    let joint = message(
        "JointState",
        &[
            field("name", 1, false, TEXT, ""),
            field("position", 2, false, DOUBLE, ""),
            field("velocity", 3, false, DOUBLE, ""),
        ],
    );
    let joints = message(
        "JointStates",
        &[
            field("timestamp", 1, false, MESSAGE, ".google.protobuf.Timestamp"),
            field("joints", 2, true, MESSAGE, ".foxglove.JointState"),
        ],
    );
    [
        descriptor_file("google/protobuf/timestamp.proto", "google.protobuf", &[], &[timestamp]),
        descriptor_file(
            "foxglove/JointStates.proto",
            "foxglove",
            &["google/protobuf/timestamp.proto"],
            &[joint, joints],
        ),
    ]
    .concat()
}

pub(crate) fn joint_states_message(k: i64, q: &[f64]) -> Vec<u8> {
    let time = [integer(1, (stamp(k) / 1_000_000_000) as u64), integer(2, (stamp(k) % 1_000_000_000) as u64)]
        .concat();
    let joint = |name: &str, q: f64| nested(2, &[nested(1, name.as_bytes()), double(2, q)].concat());
    [nested(1, &time), joint("a", q[0]), joint("b", q[1])].concat()
}

pub(crate) fn log_of(schema: &[u8]) -> Log {
    let mut log = Log::of_plan();
    let channel =
        Channel::cdr("/joints", "foxglove.JointStates").with_schema("protobuf", schema).encoded("protobuf");
    log.add(channel, 0..SAMPLES, |k| joint_states_message(k, &measurement(k)));
    log
}

#[test]
fn foxglove_joint_states() {
    let recording = read(&log_of(&joint_states()));
    assert_values(&recording.measured, measurement);
    assert_eq!(recording.source.time_base, hydrotrace::log::TimeBase::Header);
    assert!(recording.remarks.is_empty(), "{:?}", recording.remarks);
}

#[test]
fn broken_descriptors_cost_that_channel_only() {
    let mut log = log_of(&joint_states()[7..]);
    add_joint_state(&mut log, "/joint_states", measurement);
    let recording = read(&log);
    assert_values(&recording.measured, measurement);
    assert_eq!(count(&recording.remarks, Code::UnreadableSchema) as i64, SAMPLES, "{:?}", recording.remarks);
}
