//! The same log in every container: compressions, chunks, summaries, split bags.

use mcap::{Compression, WriteOptions};

use super::{file::store, *};

#[test]
fn how_a_log_is_stored_does_not_matter() {
    let log = plain_log();
    let usual = read(&log);
    assert_usual(&usual);
    let small = || WriteOptions::new().chunk_size(Some(1000));
    for (name, options) in [
        ("whole", WriteOptions::new()),
        ("none", small().compression(None)),
        ("zstd", small().compression(Some(Compression::Zstd))),
        ("no crc", small().calculate_chunk_crcs(false)),
        ("chunkless", WriteOptions::new().use_chunks(false)),
        ("no summary", small().emit_summary_records(false).emit_summary_offsets(false)),
        ("no statistics", small().emit_statistics(false)),
        ("no repeats", small().repeat_channels(false).repeat_schemas(false)),
        ("chunkless, no summary", WriteOptions::new().use_chunks(false).emit_summary_records(false)),
    ] {
        let recording = read_bytes(&log.bytes(options), &ReadOptions::default()).unwrap();
        assert_eq!(recording, usual, "{name}");
    }
    for (compression, per_chunk) in [("", 7), ("lz4", 7), ("lz4", 1000), ("zstd", 1), ("loose", 1)] {
        let recording = read_bytes(&log.by_hand(compression, per_chunk), &ReadOptions::default()).unwrap();
        assert_eq!(recording, usual, "{compression:?} {per_chunk}");
    }
}

/// The log in three files of a bag.
fn parts(log: &Log) -> Vec<Vec<u8>> {
    (0..3)
        .map(|part| {
            let mut log = log.clone();
            let mut k = 0;
            log.messages.retain(|_| {
                k += 1;
                (k - 1) * 3 / (2 * SAMPLES) == part
            });
            log.bytes(WriteOptions::new())
        })
        .collect()
}

fn bag(names: &[&str], metadata: Option<&str>) -> Recording {
    let log = plain_log();
    let parts = parts(&log);
    let mut files: Vec<(&str, &[u8])> = names.iter().copied().zip(parts.iter().map(Vec::as_slice)).collect();
    if let Some(text) = metadata {
        files.push(("metadata.yaml", text.as_bytes()));
    }
    let stored = store(&files);
    hydrotrace::log::read_recording(&[stored.folder.path().to_owned()], &ReadOptions::default()).unwrap()
}

#[test]
fn a_split_bag_is_one_recording() {
    let names = ["run_0.mcap", "run_2.mcap", "run_10.mcap"];
    assert_eq!(bag(&names, None), read(&plain_log()));
    let parts = parts(&plain_log());
    let stored = store(&[("x", &parts[0]), ("y", &parts[1]), ("z", &parts[2])]);
    let recording = hydrotrace::log::read_recording(&stored.paths, &ReadOptions::default()).unwrap();
    assert_eq!(recording, read(&plain_log()));
}

const METADATA: &str = "rosbag2_bagfile_information:\n  version: 9\n  storage_identifier: mcap\n  duration:\n    nanoseconds: 980000000\n  \
    topics_with_message_count:\n    - topic_metadata:\n        name: /joint_states\n        offered_qos_profiles:\n          - history: keep_last\n      message_count: 50\n  \
    relative_file_paths:\n    - first.mcap\n    - second.mcap\n    - a_third.mcap\n  files:\n    - path: first.mcap\n      message_count: 30\n";

#[test]
fn the_description_of_a_bag_says_the_order_of_its_files() {
    assert_eq!(bag(&["first.mcap", "second.mcap", "a_third.mcap"], Some(METADATA)), read(&plain_log()));
    let flow = "{rosbag2_bagfile_information: {relative_file_paths: [first.mcap, \"second.mcap\", a_third.mcap], storage_identifier: mcap}}";
    assert_eq!(bag(&["first.mcap", "second.mcap", "a_third.mcap"], Some(flow)), read(&plain_log()));
}

#[test]
fn a_missing_file_is_said_and_the_rest_read() {
    let recording = bag(&["first.mcap", "second.mcap"], Some(METADATA));
    assert_eq!(count(&recording.remarks, Code::MissingFile), 1);
    assert!(recording.remarks.as_slice()[0].message.contains("a_third.mcap"));
    assert!(recording.measured.tracks[0].len() < 40);
}

#[test]
fn hostile_descriptions_are_refused() {
    let laughs = (1..30).fold("a0: &a0 [x, x]\n".to_owned(), |text, k| {
        text + &format!("a{k}: &a{k} [*a{0}, *a{0}]\n", k - 1)
    });
    let deep = format!("rosbag2_bagfile_information: {}", "[".repeat(200_000));
    let steps = "- ".repeat(200_000);
    for text in
        [laughs.as_str(), &deep, &steps, "", "\0", "a: *nowhere", "? ? ? ?", "rosbag2_bagfile_information: 5"]
    {
        let stored = store(&[("metadata.yaml", text.as_bytes())]);
        let message =
            hydrotrace::log::read_recording(&[stored.folder.path().to_owned()], &ReadOptions::default())
                .unwrap_err()
                .to_string();
        assert!(message.contains("metadata.yaml"), "{message}");
    }
}

#[test]
fn attachments_and_metadata_are_handed_on() {
    let mut writer = mcap::Writer::new(std::io::Cursor::new(Vec::new())).unwrap();
    writer
        .attach(&mcap::Attachment {
            log_time: 1,
            create_time: 1,
            name: "task.json".into(),
            media_type: "application/json".into(),
            data: b"{}"[..].into(),
        })
        .unwrap();
    let metadata = std::collections::BTreeMap::from([("arm".to_owned(), "left".to_owned())]);
    writer
        .write_metadata(&mcap::records::Metadata { name: "site".into(), metadata: metadata.clone() })
        .unwrap();
    writer.finish().unwrap();
    let other = writer.into_inner().into_inner();
    let stored = store(&[("a", &plain_log().bytes(WriteOptions::new())), ("b", &other)]);
    let recording = hydrotrace::log::read_recording(&stored.paths, &ReadOptions::default()).unwrap();
    assert_eq!(recording.attachments[0].data, b"{}");
    assert_eq!(recording.metadata["site"], metadata);
}

#[test]
fn a_chunk_in_which_nothing_is_wanted_is_counted_and_not_read() {
    let mut log = plain_log();
    let usual = read(&log);
    let camera =
        log.channel(Channel::cdr("/camera", "mine/msg/Image").with_schema("ros2msg", "uint8[] data\n"));
    let joints = log.messages.clone();
    // A chunk of pictures between two of joints.
    let picture = [0xAB; 3000];
    log.messages.truncate(60);
    (20..30).for_each(|k| log.send(camera, stamp(k), picture.to_vec()));
    log.messages.extend_from_slice(&joints[60..]);
    let options = mcap::WriteOptions::new().chunk_size(Some(12_000)).compression(None);
    let mut bytes = log.bytes(options);
    let at = bytes.windows(40).position(|window| window == [0xAB; 40]).unwrap();
    // A broken picture breaks the checksum of its chunk; a report never looks.
    let chunk = bytes[at + 9000];
    assert_eq!(chunk, 0xAB);
    bytes[at + 9000] = 0;
    let survey = survey_bytes(&bytes);
    let camera = survey.topics.iter().find(|topic| topic.topic == "/camera").unwrap();
    assert_eq!(camera.messages, 10);
    assert!((camera.rate_hz - 50.0).abs() < 10.0, "{}", camera.rate_hz);
    let found = read_bytes(&bytes, &ReadOptions::default()).unwrap();
    assert_eq!((&found.planned, &found.measured), (&usual.planned, &usual.measured));
}
