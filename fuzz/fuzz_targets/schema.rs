//! Any text as the schema of a log, any bytes as its message. The first byte chooses the
//! notation; a zero byte ends the text.
#![no_main]

use hydrotrace::log::{ReadOptions, survey_bytes};
use libfuzzer_sys::fuzz_target;

fn record(opcode: u8, body: &[u8]) -> Vec<u8> {
    [&[opcode][..], &(body.len() as u64).to_le_bytes(), body].concat()
}

fn block(bytes: &[u8]) -> Vec<u8> {
    [&(bytes.len() as u32).to_le_bytes()[..], bytes].concat()
}

fuzz_target!(|bytes: &[u8]| {
    let Some((&choice, rest)) = bytes.split_first() else { return };
    let end = rest.iter().position(|&byte| byte == 0).unwrap_or(rest.len());
    let (text, message) = (&rest[..end], rest.get(end + 1..).unwrap_or_default());
    let (name, notation, encoding) = match choice % 4 {
        0 => ("sensor_msgs/msg/JointState", "ros2idl", "cdr"),
        1 => ("trajectory_msgs/msg/JointTrajectory", "ros2msg", "cdr"),
        2 => ("foxglove.JointStates", "protobuf", "protobuf"),
        _ => ("sensor_msgs/msg/JointState", "ros2msg", "cdr"),
    };
    // Descriptors may hold zeros: they go on to the end, and the messages are the same bytes.
    let text = if choice % 4 == 2 { rest } else { text };
    let schema = [&[1, 0][..], &block(name.as_bytes()), &block(notation.as_bytes()), &block(text)].concat();
    let channel = [&[1, 0, 1, 0][..], &block(b"/planned"), &block(encoding.as_bytes()), &block(&[])].concat();
    let sample = [&[1, 0][..], &[0; 20], message].concat();
    let log = [b"\x89MCAP0\r\n".to_vec(), record(3, &schema), record(4, &channel), record(5, &sample)].concat();
    let _ = survey_bytes(&log, &ReadOptions::default());
});
