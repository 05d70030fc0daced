//! Logs of one message, in bytes.

use std::sync::OnceLock;

/// Type, notation of its definition, and encoding of its messages.
pub const NOTATIONS: [(&str, &str, &str); 7] = [
    ("sensor_msgs/msg/JointState", "ros2idl", "cdr"),
    ("trajectory_msgs/msg/JointTrajectory", "ros2msg", "cdr"),
    ("foxglove.JointStates", "protobuf", "protobuf"),
    ("sensor_msgs/msg/JointState", "ros2msg", "cdr"),
    ("control_msgs/msg/DynamicJointState", "ros2msg", "cdr"),
    ("control_msgs/msg/JointTrajectoryControllerState", "ros2idl", "cdr"),
    ("sensor_msgs/JointState", "ros1msg", "ros1"),
];

macro_rules! message {
    ($($package:literal $name:literal),*) => {
        [$((concat!($package, "/", $name),
            include_str!(concat!("../../schemas/ros2/", $package, "/msg/", $name, ".msg")))),*]
    };
}

/// Types with their whole definitions.
pub fn types() -> &'static [(String, String)] {
    static TYPES: OnceLock<Vec<(String, String)>> = OnceLock::new();
    TYPES.get_or_init(|| {
        let all = message![
            "sensor_msgs" "JointState",
            "control_msgs" "JointTrajectoryControllerState",
            "trajectory_msgs" "JointTrajectory",
            "control_msgs" "DynamicJointState",
            "control_msgs" "InterfaceValue",
            "trajectory_msgs" "JointTrajectoryPoint",
            "trajectory_msgs" "MultiDOFJointTrajectoryPoint",
            "geometry_msgs" "Transform",
            "geometry_msgs" "Twist",
            "geometry_msgs" "Vector3",
            "geometry_msgs" "Quaternion",
            "std_msgs" "Header",
            "builtin_interfaces" "Time",
            "builtin_interfaces" "Duration"
        ];
        let line = "=".repeat(80);
        let rest: String = all.iter().map(|(name, text)| format!("{line}\nMSG: {name}\n{text}\n")).collect();
        let named = |(name, text): &(&str, &str)| (name.replacen('/', "/msg/", 1), format!("{text}\n{rest}"));
        all[..4].iter().map(named).collect()
    })
}

fn record(opcode: u8, body: &[u8]) -> Vec<u8> {
    [&[opcode][..], &(body.len() as u64).to_le_bytes(), body].concat()
}

fn block(bytes: &[u8]) -> Vec<u8> {
    [&(bytes.len() as u32).to_le_bytes()[..], bytes].concat()
}

/// A log of one message of one type, planned and measured.
pub fn of(name: &str, notation: &str, definition: &[u8], encoding: &str, message: &[u8]) -> Vec<u8> {
    let schema =
        [&[1, 0][..], &block(name.as_bytes()), &block(notation.as_bytes()), &block(definition)].concat();
    let channel = |id: u8, topic: &[u8]| {
        record(4, &[&[id, 0, 1, 0][..], &block(topic), &block(encoding.as_bytes()), &block(&[])].concat())
    };
    let sample = |id: u8| record(5, &[&[id, 0][..], &[0; 20], message].concat());
    let topics = [channel(1, b"/planned"), channel(2, b"/measured"), sample(1), sample(2)].concat();
    [b"\x89MCAP0\r\n".to_vec(), record(3, &schema), topics].concat()
}

fn nested(number: u8, bytes: &[u8]) -> Vec<u8> {
    let length = bytes.len();
    let low = if length < 128 { vec![length as u8] } else { vec![length as u8 | 0x80, (length >> 7) as u8] };
    [vec![number << 3 | 2], low, bytes.to_vec()].concat()
}

/// The descriptor of `foxglove.JointStates`, short.
pub fn descriptor() -> Vec<u8> {
    let field = |name: &str, number: u8, label: u8, kind: u8, of: &str| {
        let mut bytes = nested(1, name.as_bytes());
        bytes.extend([3 << 3, number, 4 << 3, label, 5 << 3, kind]);
        if !of.is_empty() {
            bytes.extend(nested(6, of.as_bytes()));
        }
        nested(2, &bytes)
    };
    let joint =
        [nested(1, b"JointState"), field("name", 1, 1, 9, ""), field("position", 2, 1, 1, "")].concat();
    let states = [nested(1, b"JointStates"), field("joints", 2, 3, 11, ".foxglove.JointState")].concat();
    let parts = [
        nested(1, b"a.proto"),
        nested(2, b"foxglove"),
        nested(4, &joint),
        nested(4, &states),
        nested(12, b"proto3"),
    ];
    nested(1, &parts.concat())
}

/// A message of that type.
pub fn protobuf_message() -> Vec<u8> {
    let joint = |name: &[u8]| [nested(1, name), vec![2 << 3 | 1], 0.5_f64.to_le_bytes().to_vec()].concat();
    [nested(2, &joint(b"a")), nested(2, &joint(b"b"))].concat()
}
