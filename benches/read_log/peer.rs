//! The same fields read by Python's rosbags.

use std::{path::Path, process::Command};

/// CPU time a message over the first `messages`, s; `None` without Python or rosbags.
pub(crate) fn rosbags(path: &Path, messages: usize) -> Option<f64> {
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/benches/read_log/rosbags_read.py");
    let output = Command::new("python3").arg(script).arg(path).arg(messages.to_string()).output().ok()?;
    String::from_utf8(output.stdout).ok()?.trim().parse().ok()
}
