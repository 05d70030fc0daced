//! Other people's readers must open what we write; `peers/check_peers.py` asks them.

use std::process::Command;

use hydrotrace::log::{LogWriter, WriteOptions};

use super::write_run;
use crate::support::root;

/// Runs on request, `cargo test --test it log_write -- --ignored`; `PYTHON` names the interpreter.
#[test]
#[ignore = "needs Python with tests/peers/requirements.txt"]
fn other_readers_agree_on_what_a_log_says() {
    let folder = tempfile::tempdir().unwrap();
    let finished = folder.path().join("finished.mcap");
    let live = folder.path().join("live.mcap");
    for (path, options) in [(&finished, WriteOptions::default()), (&live, WriteOptions::live())] {
        let mut log = LogWriter::create(path, &super::JOINTS, options).unwrap();
        write_run(&mut log, 500);
        log.finish().unwrap();
    }
    let script = root().join("tests/peers/check_peers.py");
    let python = std::env::var_os("PYTHON").unwrap_or_else(|| "python3".into());
    let status = Command::new(python).arg(script).args([finished, live]).status().unwrap();
    assert!(status.success());
}
