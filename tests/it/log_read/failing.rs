//! Logs that lie elsewhere than in a file, in stores that fail: whatever fails, what is missing is said.

use std::{
    io,
    ops::Range,
    sync::{
        Arc,
        atomic::{AtomicU64, Ordering},
    },
};

use hydrotrace::log::{Input, LogFiles, ReadAt};

use hydrotrace::series::Track;

use super::*;
use crate::support::sample;

/// What a store does besides giving its bytes.
#[derive(Debug, Clone)]
enum Fault {
    None,
    /// A few bytes at a time, and interrupted each other time.
    Slow,
    /// Reads of these numbers fail.
    Reads(Range<u64>),
    /// Bytes of these places are never given.
    Places(Range<u64>),
}

/// Bytes in a store.
#[derive(Debug)]
struct Store {
    bytes: Arc<Vec<u8>>,
    fault: Fault,
    reads: Arc<AtomicU64>,
    failed: Arc<AtomicU64>,
}

impl ReadAt for Store {
    fn length(&self) -> io::Result<u64> {
        Ok(self.bytes.len() as u64)
    }

    fn read_at(&self, into: &mut [u8], at: u64) -> io::Result<usize> {
        let read = self.reads.fetch_add(1, Ordering::Relaxed);
        let end = at + into.len() as u64;
        let fails = match &self.fault {
            Fault::Reads(reads) => reads.contains(&read),
            Fault::Places(places) => at < places.end && places.start < end,
            Fault::Slow if read % 2 == 1 => return Err(io::ErrorKind::Interrupted.into()),
            _ => false,
        };
        if fails {
            self.failed.fetch_add(1, Ordering::Relaxed);
            return Err(io::Error::other("the store does not answer"));
        }
        let rest = self.bytes.get(at as usize..).unwrap_or_default();
        let most = if matches!(self.fault, Fault::Slow) { 4097 } else { usize::MAX };
        let count = into.len().min(rest.len()).min(most);
        into[..count].copy_from_slice(&rest[..count]);
        Ok(count)
    }
}

/// What was read, how often it was read, how often that failed.
fn read_under(bytes: &Arc<Vec<u8>>, fault: Fault) -> (Result<Recording, LogError>, u64, u64) {
    let (reads, failed) = (Arc::<AtomicU64>::default(), Arc::<AtomicU64>::default());
    let store = Store { bytes: bytes.clone(), fault, reads: reads.clone(), failed: failed.clone() };
    let input = Input::Reader { name: "store.mcap".to_owned(), reader: Box::new(store) };
    let read = LogFiles::of(vec![input]).and_then(|files| files.scan()?.read(&ReadOptions::default()));
    (read, reads.load(Ordering::Relaxed), failed.load(Ordering::Relaxed))
}

fn samples(recording: &Recording) -> usize {
    [&recording.measured, &recording.planned]
        .into_iter()
        .flat_map(|series| &series.tracks)
        .map(Track::len)
        .sum()
}

#[test]
fn a_store_gives_what_the_file_gives_and_so_do_bytes() {
    for name in ["task-1-run.mcap", "gaps.mcap"] {
        let bytes = Arc::new(std::fs::read(sample(name)).unwrap());
        let file = hydrotrace::log::read_recording(&[sample(name)], &ReadOptions::default()).unwrap();
        for fault in [Fault::None, Fault::Slow] {
            let (read, ..) = read_under(&bytes, fault);
            let read = read.unwrap();
            assert_eq!((&read.measured, &read.planned), (&file.measured, &file.planned), "{name}");
            assert_eq!(read.remarks, file.remarks, "{name}");
        }
        let input = Input::Bytes { name: "store.mcap".to_owned(), data: bytes.to_vec() };
        let read = LogFiles::of(vec![input]).unwrap().scan().unwrap().read(&ReadOptions::default()).unwrap();
        assert_eq!((&read.measured, &read.planned), (&file.measured, &file.planned), "{name}");
    }
}

#[test]
fn whatever_a_store_does_not_give_is_an_error_that_names_it_or_a_remark() {
    let (mut errors, mut remarked) = (0, 0);
    // Of one chunk, and of many.
    for name in ["task-1-run.mcap", "panel-install.mcap"] {
        let bytes = Arc::new(std::fs::read(sample(name)).unwrap());
        let (whole, reads, _) = read_under(&bytes, Fault::None);
        let whole = samples(&whole.unwrap());
        let length = bytes.len() as u64;
        println!("{name}: {} faults", 2 * reads + 200);
        let once = (0..reads).map(|n| Fault::Reads(n..n + 1));
        let for_good = (0..reads).map(|n| Fault::Reads(n..u64::MAX));
        let places = (0..200).map(|k| length * k / 200).map(|at| Fault::Places(at..at + 512));
        for fault in once.chain(for_good).chain(places) {
            match read_under(&bytes, fault.clone()) {
                (Err(error), ..) => {
                    errors += 1;
                    assert!(error.to_string().contains("store"), "{fault:?}: {error}");
                }
                (Ok(read), _, failed) => {
                    let damaged = |code: &Code| matches!(code, Code::DamagedBytes | Code::DamagedChunk);
                    let said = codes(&read.remarks).iter().any(damaged);
                    remarked += u32::from(said);
                    assert!(said || failed == 0 || samples(&read) == whole, "{fault:?}: {failed}");
                    assert!(samples(&read) <= whole, "{fault:?}");
                }
            }
        }
    }
    assert!(errors > 0 && remarked > 0, "{errors} errors, {remarked} remarked");
}
