//! What is in a large closed log, by its summary alone.

use std::{
    io,
    sync::{
        Arc,
        atomic::{AtomicU64, Ordering},
    },
};

use hydrotrace::{
    log::{Input, LogFiles, ReadAt},
    workflow::info,
};
use mcap::WriteOptions;

use super::{cdr::Kind, encode::joint_state, file::store, *};

/// Bytes in a store that counts what is read of them.
#[derive(Debug)]
struct Counting {
    bytes: Vec<u8>,
    read: Arc<AtomicU64>,
}

impl ReadAt for Counting {
    fn length(&self) -> io::Result<u64> {
        Ok(self.bytes.len() as u64)
    }

    fn read_at(&self, into: &mut [u8], at: u64) -> io::Result<usize> {
        let rest = self.bytes.get(at as usize..).unwrap_or_default();
        let count = into.len().min(rest.len());
        into[..count].copy_from_slice(&rest[..count]);
        self.read.fetch_add(count as u64, Ordering::Relaxed);
        Ok(count)
    }
}

/// Joints at 50 Hz, and pictures of 250 kB that fill up to the size.
fn bag(megabytes: usize) -> Vec<u8> {
    let mut log = Log::default();
    let joints = ["/planned/joint_states", "/joint_states"]
        .map(|topic| log.channel(Channel::cdr(topic, "sensor_msgs/msg/JointState")));
    let picture = Channel::cdr("/camera/image", "sensor_msgs/msg/Image");
    let picture = log.channel(picture.with_schema("ros2msg", "uint8[] data\n"));
    for k in 0..4 * megabytes as i64 {
        for channel in joints {
            log.send(channel, stamp(k), joint_state(Kind::LittleEndian, stamp(k), &NAMES, &plan(k), &[]));
        }
        log.send(picture, stamp(k), vec![7; 250_000]);
    }
    let options = WriteOptions::new().compression(None).chunk_size(Some(1 << 20));
    log.bytes(options.calculate_chunk_crcs(false).calculate_data_section_crc(false))
}

fn opened(bytes: Vec<u8>) -> (LogFiles, Arc<AtomicU64>) {
    let read = Arc::<AtomicU64>::default();
    let reader = Box::new(Counting { bytes, read: read.clone() });
    let files = LogFiles::of(vec![Input::Reader { name: "bag.mcap".to_owned(), reader }]).unwrap();
    (files, read)
}

#[test]
fn the_summary_of_a_large_bag_tells_what_is_in_it() {
    let bytes = bag(200);
    let size = bytes.len() as u64;
    let (files, read) = opened(bytes);
    let survey = files.survey_by_index().unwrap();
    let read = read.load(Ordering::Relaxed);
    println!("{read} bytes read of {size}");
    assert!(size > 200_000_000 && read < 1_000_000, "{read} of {size}");
    let counts: Vec<_> = survey.topics.iter().map(|t| (t.topic.as_str(), t.messages)).collect();
    assert_eq!(counts, [("/camera/image", 800), ("/joint_states", 800), ("/planned/joint_states", 800)]);
    assert!(survey.topics.iter().all(|topic| (topic.rate_hz - 50.0).abs() < 1e-6), "{:?}", survey.topics);
    assert_eq!(survey.topics[1].joint_fields, ["position"]);
    assert!((survey.duration_s - 799.0 * 0.02).abs() < 1e-9 && !survey.is_checked());
    let why = survey.recording.unwrap_err().to_string();
    assert!(why.contains("`hydrotrace info --check bag.mcap`"), "{why}");
}

#[test]
fn it_agrees_with_what_reading_all_of_it_finds() {
    let (files, _) = opened(bag(3));
    let (quick, whole) = (files.survey_by_index().unwrap(), files.survey(&ReadOptions::default()).unwrap());
    let told = |survey: &Survey| -> Vec<_> {
        let topics = survey.topics.iter();
        topics.map(|t| (t.topic.clone(), t.messages, t.rate_hz, t.joint_fields.clone())).collect()
    };
    assert_eq!(told(&quick), told(&whole));
    assert_eq!((&quick.files, quick.duration_s), (&whole.files, whole.duration_s));
    assert!(whole.is_checked() && whole.recording.is_ok());
}

#[test]
fn a_summary_that_cannot_be_relied_on_is_none() {
    let log = plain_log();
    let whole = log.bytes(WriteOptions::new());
    assert!(opened(whole.clone()).0.survey_by_index().is_some());
    assert!(opened(log.by_hand("zstd", 7)).0.survey_by_index().is_none());
    assert!(opened(log.bytes(WriteOptions::new().emit_statistics(false))).0.survey_by_index().is_none());
    for cut in 1..40 {
        assert!(opened(whole[..whole.len() - cut].to_vec()).0.survey_by_index().is_none(), "{cut}");
    }
    // A byte of the summary that is another.
    let mut bent = whole.clone();
    let at = whole.len() - 120;
    bent[at] ^= 0x40;
    assert!(opened(bent).0.survey_by_index().is_none());
}

#[test]
fn a_log_that_is_small_or_to_be_checked_is_read_whole() {
    let small = store(&[("run.mcap", &plain_log().bytes(WriteOptions::new()))]);
    let large = store(&[("run.mcap", &bag(70))]);
    let checked = |paths: &[PathBuf], check: bool, read: ReadOptions| {
        info::run(&info::Inputs { logs: paths.to_vec(), read, check }).unwrap().is_checked()
    };
    assert!(checked(&small.paths, false, ReadOptions::default()));
    assert!(!checked(&large.paths, false, ReadOptions::default()));
    assert!(checked(&large.paths, true, ReadOptions::default()));
    assert!(checked(&large.paths, false, options(&[], &["/joint_states"], &[])));
}
