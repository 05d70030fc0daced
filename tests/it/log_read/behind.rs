//! What lies behind a recording in its file: zeros of a page that was never written, or another recording.

use mcap::WriteOptions;

use super::{file::*, *};

/// A log in one chunk, which holds the definitions, too.
fn one_chunk(first_ns: u64) -> Log {
    let mut log = plain_log();
    for message in &mut log.messages {
        message.log_ns += first_ns;
        message.publish_ns += first_ns;
    }
    log.messages = (0..20).flat_map(|_| log.messages.clone()).collect();
    log
}

/// Messages that `recover` saves of a file, and its remarks.
fn saved(bytes: &[u8]) -> (u64, Remarks) {
    let stored = store(&[("behind.mcap", bytes)]);
    let output = stored.folder.path().join("saved.mcap");
    let saved = hydrotrace::log::recover(&stored.paths, &output).unwrap();
    let again =
        hydrotrace::log::survey_bytes(&std::fs::read(&output).unwrap(), &ReadOptions::default()).unwrap();
    assert_eq!(again.topics.iter().map(|topic| topic.messages).sum::<u64>(), saved.messages);
    (saved.messages, saved.remarks)
}

fn written(log: &Log) -> Vec<u8> {
    log.bytes(WriteOptions::new().compression(None))
}

#[test]
fn a_cut_log_in_zeros_keeps_what_was_written_of_its_only_chunk() {
    let whole = written(&one_chunk(0));
    let cut = whole.len() / 2;
    for zeros in [1000, whole.len()] {
        let (messages, remarks) = saved(&[&whole[..cut], &vec![0; zeros]].concat());
        assert!((900..1300).contains(&messages), "{zeros}: {messages} {remarks:?}");
    }
}

#[test]
fn a_recording_behind_another_is_read_with_it() {
    let first = written(&one_chunk(0));
    let second = written(&one_chunk(1_000_000_000_000));
    for (cut, least) in [(first.len(), 4000), (first.len() / 2, 2900), (first.len() * 9 / 10, 3800)] {
        for between in [0, 500] {
            let bytes = [&first[..cut], &vec![0; between], &second[..]].concat();
            let (messages, remarks) = saved(&bytes);
            assert!((least..=4000).contains(&messages), "cut at {cut}: {messages} {remarks:?}");
            let told = remarks.as_slice().iter().any(|one| one.message.contains("one behind another"));
            assert!(told, "{remarks:?}");
        }
    }
}

#[test]
fn a_recording_that_stands_in_a_file_twice_is_read_once() {
    let log = written(&one_chunk(0));
    let (messages, remarks) = saved(&[&log[..], &log].concat());
    assert_eq!(messages, 2000);
    let at = format!("stands at byte {} of behind.mcap", log.len());
    assert!(remarks.as_slice().iter().any(|one| one.message.contains(&at)), "{remarks:?}");
}

#[test]
fn channels_of_a_recording_behind_another_are_its_own() {
    let first = written(&one_chunk(0));
    let mut other = one_chunk(1_000_000_000_000);
    other.channels.reverse();
    for message in &mut other.messages {
        message.channel = 1 - message.channel;
    }
    let survey = |bytes: &[u8]| hydrotrace::log::survey_bytes(bytes, &ReadOptions::default()).unwrap().topics;
    let both = survey(&[first.clone(), written(&other)].concat());
    let alone = survey(&first);
    assert_eq!(both.len(), alone.len());
    for (both, alone) in both.iter().zip(&alone) {
        assert_eq!((&both.topic, both.messages), (&alone.topic, 2 * alone.messages));
    }
}
