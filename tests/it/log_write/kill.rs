//! A writer may be killed at any instant. `HYDROTRACE_KILLS=1000 cargo test --test it log_write::kill -- --nocapture`
//! kills more often than once.

use std::{
    cell::RefCell,
    io::{self, Write},
    process::{Command, Stdio},
    rc::Rc,
};

use hydrotrace::log::{LogWriter, Role, WriteError, WriteOptions};
use mcap::{MessageStream, read};

use super::{JOINTS, START_NS};

/// How many messages a torn log gives before it breaks off.
pub(super) fn readable(bytes: &[u8]) -> usize {
    let options = read::Options::IgnoreEndMagic | read::Options::ValidateChunkCrcs;
    match MessageStream::new_with_options(bytes, options) {
        Ok(messages) => messages.take_while(Result::is_ok).count(),
        Err(_) => 0,
    }
}

pub(super) fn sample<W: Write>(log: &mut LogWriter<W>, k: i64) -> Result<(), WriteError> {
    let position_rad = [0.1 * k as f64, 0.0, 1.0];
    log.joint_sample(Role::Measured, START_NS + k * 20_000_000, &position_rad, &[], &[])
}

/// Bytes that outlive their writer.
#[derive(Clone, Default)]
struct Shared(Rc<RefCell<Vec<u8>>>);

impl Write for Shared {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.borrow_mut().write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[test]
fn a_log_cut_anywhere_reads_back_up_to_the_last_flush() {
    let output = Shared::default();
    let mut log = LogWriter::new(output.clone(), &JOINTS, WriteOptions::default()).unwrap();
    let mut flushed = vec![(0, 0)];
    for k in 0..60 {
        sample(&mut log, k).unwrap();
        if k % 7 == 6 {
            log.flush().unwrap();
            flushed.push((output.0.borrow().len(), k as usize + 1));
        }
    }
    log.finish().unwrap();
    let bytes = output.0.borrow();
    for cut in 0..=bytes.len() {
        let (_, kept) = flushed.iter().rfind(|(length, _)| *length <= cut).unwrap();
        assert!(readable(&bytes[..cut]) >= *kept, "cut at byte {cut} of {}", bytes.len());
    }
}

#[test]
fn a_flush_is_due_after_the_interval_of_stamps() {
    let output = Shared::default();
    let options = WriteOptions { flush_interval_ns: Some(100_000_000), ..WriteOptions::default() };
    let mut log = LogWriter::new(output.clone(), &JOINTS, options).unwrap();
    let mut kept = Vec::new();
    for k in 0..13 {
        sample(&mut log, k).unwrap();
        kept.push(readable(&output.0.borrow()));
    }
    assert_eq!(kept, [0, 0, 0, 0, 0, 6, 6, 6, 6, 6, 6, 12, 12]);
}

#[test]
fn a_full_disk_is_an_error_each_time_and_never_a_panic() {
    struct Full(usize);
    impl Write for Full {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            let taken = bytes.len().min(self.0);
            self.0 -= taken;
            if taken == 0 { Err(io::Error::from(io::ErrorKind::StorageFull)) } else { Ok(taken) }
        }
        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }
    for room in 0..1200 {
        let Ok(mut log) = LogWriter::new(Full(room), &JOINTS, WriteOptions::default()) else { continue };
        let written = sample(&mut log, 0).and_then(|()| log.flush());
        if written.is_err() {
            assert!(matches!(sample(&mut log, 1), Err(WriteError::Output(_))), "room {room}");
            assert!(log.finish().is_err());
        }
    }
}

/// Where the killed process writes; unset in ordinary runs of the tests.
const VICTIM: &str = "HYDROTRACE_TEST_VICTIM";

#[test]
fn a_killed_process_loses_nothing_it_had_flushed() {
    if let Some(path) = std::env::var_os(VICTIM) {
        return be_killed(path.as_ref());
    }
    let count = std::env::var("HYDROTRACE_KILLS").map_or(1, |text| text.parse().unwrap());
    let folder = tempfile::tempdir().unwrap();
    let [mut announced, mut read] = [0; 2];
    for k in 0..count {
        let found = killed(&folder.path().join("live.mcap"), k);
        announced += found.0;
        read += found.1;
    }
    println!("{count} kills: {announced} samples were flushed, {read} read back");
}

/// Samples that a process said it had flushed before it was killed, and those that can be read.
fn killed(path: &std::path::Path, k: usize) -> (usize, usize) {
    let mut child = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "log_write::kill::a_killed_process_loses_nothing_it_had_flushed", "--nocapture"])
        .env(VICTIM, path)
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut lines = io::BufRead::lines(io::BufReader::new(child.stdout.take().unwrap()))
        .map_while(Result::ok)
        .filter_map(|line| line.split_once("flushed ").and_then(|(_, n)| n.parse::<usize>().ok()));
    let enough = lines.find(|&n| n >= 500 * (1 + k * 7 % 40)).unwrap();
    std::thread::sleep(std::time::Duration::from_micros(137 * (k as u64 % 31)));
    child.kill().unwrap();
    child.wait().unwrap();
    // What it said until then counts, too; without a reader it would have panicked instead.
    let announced = lines.last().unwrap_or(enough);
    let bytes = std::fs::read(path).unwrap();
    std::fs::remove_file(path).unwrap();
    assert!(!bytes.ends_with(mcap::MAGIC), "the log was closed");
    let read = readable(&bytes);
    assert!(read >= announced, "kill {k}: {read} of {announced}");
    (announced, read)
}

/// Logs without end and says how many samples are safe.
fn be_killed(path: &std::path::Path) {
    let mut log = LogWriter::create(path, &JOINTS, WriteOptions::default()).unwrap();
    for k in 0_i64..50_000_000 {
        sample(&mut log, k).unwrap();
        if k % 500 == 499 {
            log.flush().unwrap();
            println!("flushed {}", k + 1);
        }
    }
}
