//! Damaged files: what is whole is read, what is not is said.

use mcap::WriteOptions;

use super::{file::*, *};

/// Chunks of ten messages.
fn chunks(compression: &str, log: &Log) -> Vec<Vec<u8>> {
    log.messages.chunks(10).map(|messages| chunk(compression, &message_records(messages))).collect()
}

/// A file of these chunks after all definitions.
fn file_of(log: &Log, chunks: &[Vec<u8>]) -> Vec<u8> {
    [MAGIC.to_vec(), log.definitions(), chunks.concat(), end()].concat()
}

fn samples(bytes: &[u8]) -> (usize, Remarks) {
    match read_bytes(bytes, &ReadOptions::default()) {
        Ok(recording) => {
            let of = |series: &Series| series.tracks.first().map_or(0, hydrotrace::series::Track::len);
            (of(&recording.planned) + of(&recording.measured), recording.remarks)
        }
        Err(error) => panic!("{error}"),
    }
}

/// One chunk replaced; it costs its ten messages and no more.
#[track_caller]
fn assert_costs_one_chunk(compression: &str, spoil: impl Fn(&mut Vec<u8>), code: Code) {
    let log = plain_log();
    let mut chunks = chunks(compression, &log);
    spoil(&mut chunks[4]);
    let (samples, remarks) = samples(&file_of(&log, &chunks));
    // Messages that are not compressed are found even where the chunk around them is not.
    assert!(samples == 90 || compression.is_empty() && code == Code::DamagedBytes, "{samples} {remarks:?}");
    assert!(count(&remarks, code) > 0, "{remarks:?}");
}

#[test]
fn one_bad_chunk_in_the_middle_costs_that_chunk_and_no_more() {
    for compression in ["", "lz4", "zstd"] {
        let flip = |chunk: &mut Vec<u8>| {
            let middle = chunk.len() * 2 / 3;
            chunk[middle] ^= 1;
        };
        assert_costs_one_chunk(compression, flip, Code::DamagedChunk);
        let zero_page = |chunk: &mut Vec<u8>| {
            let length = chunk.len();
            chunk[80..length - 9].fill(0);
        };
        assert_costs_one_chunk(compression, zero_page, Code::DamagedChunk);
        assert_costs_one_chunk(compression, |chunk| chunk.fill(0), Code::DamagedBytes);
        assert_costs_one_chunk(compression, |chunk| chunk[0] = 0x77, Code::DamagedBytes);
    }
    let inside = message_records(&plain_log().messages[40..50]);
    let packed = compressed("zstd", &inside);
    let size = inside.len() as u64;
    assert_costs_one_chunk("zstd", |chunk| *chunk = chunk_with("xz", size, 0, &packed), Code::DamagedChunk);
    assert_costs_one_chunk(
        "zstd",
        |chunk| *chunk = chunk_with("zstd", 1 << 40, 0, &packed),
        Code::DamagedChunk,
    );
    assert_costs_one_chunk(
        "zstd",
        |chunk| *chunk = chunk_with("zstd", size + 1, 0, &packed),
        Code::DamagedChunk,
    );
    assert_costs_one_chunk("zstd", |chunk| *chunk = record(6, &[]), Code::DamagedBytes);
}

#[test]
fn a_wrong_length_of_a_chunk_is_survived() {
    for length in [1_u64 << 40, u64::MAX, u64::MAX - 8, 0, 7] {
        for compression in ["", "zstd"] {
            let log = plain_log();
            let mut chunks = chunks(compression, &log);
            chunks[4][1..9].copy_from_slice(&length.to_le_bytes());
            let (samples, remarks) = samples(&file_of(&log, &chunks));
            // The inner length leads on where it agrees with what follows.
            assert!(samples >= 90, "{length}: {samples} {remarks:?}");
        }
    }
}

#[test]
fn a_wrong_length_inside_a_chunk_costs_what_follows_it_there() {
    for length in [1_u64 << 40, u64::MAX, u64::MAX - 8] {
        let log = plain_log();
        let mut chunks = chunks("zstd", &log);
        let mut inside = message_records(&log.messages[40..50]);
        let third = inside.len() / 10 * 3;
        inside[third + 1..third + 9].copy_from_slice(&length.to_le_bytes());
        chunks[4] = chunk_with("zstd", inside.len() as u64, 0, &compressed("zstd", &inside));
        let (samples, remarks) = samples(&file_of(&log, &chunks));
        assert_eq!(samples, 93);
        assert_eq!(codes(&remarks), [Code::PartialChunk], "{remarks:?}");
    }
}

#[test]
fn a_cut_chunk_yields_the_messages_before_the_cut() {
    for compression in ["", "zstd", "lz4"] {
        let mut log = plain_log();
        // Enough that a compressed block ends before the cut.
        log.messages = (0..6000)
            .map(|k| {
                let ns = stamp(k / 2);
                let values = [(k as f64 * 0.1).sin(), (k as f64 * 0.7).cos()];
                let data = encode::joint_state(cdr::Kind::LittleEndian, ns, &NAMES, &values, &[]);
                Message { channel: k as usize % 2, log_ns: ns as u64, publish_ns: ns as u64, data }
            })
            .collect();
        let bytes = log.by_hand(compression, 6000);
        let cut = &bytes[..bytes.len() * 3 / 4];
        let (samples, remarks) = samples(cut);
        assert!((3000..5400).contains(&samples), "{compression}: {samples}");
        assert_eq!(codes(&remarks), [Code::NotClosed, Code::PartialChunk], "{compression}: {remarks:?}");
    }
}

#[test]
fn every_prefix_of_a_file_is_read_as_far_as_it_goes() {
    let log = plain_log();
    for (name, bytes) in [
        ("zstd", log.bytes(WriteOptions::new().chunk_size(Some(1500)))),
        ("none", log.bytes(WriteOptions::new().chunk_size(Some(1500)).compression(None))),
        ("lz4", log.by_hand("lz4", 20)),
        ("chunkless", log.bytes(WriteOptions::new().use_chunks(false))),
    ] {
        let mut before = 0;
        for cut in 0..bytes.len() {
            let survey = hydrotrace::log::survey_bytes(&bytes[..cut], &ReadOptions::default());
            let Ok(survey) = survey else {
                assert!(cut < 8 || before == 0, "{name} cut at {cut}");
                continue;
            };
            assert!(count(&survey.remarks, Code::NotClosed) == 1, "{name} cut at {cut}");
            let messages: u64 = survey.topics.iter().map(|topic| topic.messages).sum();
            assert!(messages + 20 >= before, "{name} cut at {cut}: {messages} after {before}");
            before = before.max(messages);
        }
        assert_eq!(before, 100, "{name}");
    }
}

#[test]
fn missing_ends_and_bytes_after_them_are_said() {
    let log = plain_log();
    let whole = log.bytes(WriteOptions::new());
    let (all, remarks) = samples(&whole);
    assert_eq!((all, remarks.is_empty()), (100, true));
    let (all, remarks) = samples(&whole[..whole.len() - 8]);
    assert_eq!((all, codes(&remarks)), (100, vec![Code::NotClosed]));
    let (all, remarks) = samples(&whole[..whole.len() - 8 - 29]);
    assert_eq!((all, codes(&remarks)), (100, vec![Code::NotClosed]));
    let (all, remarks) = samples(&[&whole[..], &[7; 100]].concat());
    assert_eq!((all, codes(&remarks), remarks.as_slice()[0].count), (100, vec![Code::DamagedBytes], 100));
    let (all, remarks) = samples(&[&[0; 8], &whole[8..]].concat());
    assert_eq!((all, codes(&remarks)), (100, vec![Code::DamagedBytes]));
    let (all, remarks) = samples(&[&whole[..], &whole[..]].concat());
    assert!(all >= 100 && count(&remarks, Code::DamagedBytes) > 0, "{all} {remarks:?}");
}

#[test]
fn a_damaged_summary_is_not_believed() {
    let whole = plain_log().bytes(WriteOptions::new());
    let footer = whole.len() - 8 - 20;
    let start = u64::from_le_bytes(whole[footer..footer + 8].try_into().unwrap()) as usize;
    for at in start..footer + 20 {
        let mut bytes = whole.clone();
        bytes[at] ^= 0x10;
        let (all, remarks) = samples(&bytes);
        assert_eq!(all, 100, "byte {at}: {remarks:?}");
    }
}

#[test]
fn statistics_that_leave_out_channels_cost_nothing() {
    let log = plain_log();
    let definitions = log.definitions();
    let first = Log { channels: log.channels[..1].to_vec(), ..Log::default() }.definitions();
    let chunks: Vec<u8> = chunks("zstd", &log).concat();
    let inside = chunk("zstd", &definitions);
    let statistics = record(
        0x0B,
        &[&100_u64.to_le_bytes()[..], &1_u16.to_le_bytes(), &1_u32.to_le_bytes(), &[0; 32]].concat(),
    );
    let bytes = [
        MAGIC.to_vec(),
        inside,
        chunks,
        record(0x0F, &[0; 4]),
        first,
        statistics,
        record(2, &[0; 20]),
        MAGIC.to_vec(),
    ]
    .concat();
    let (all, remarks) = samples(&bytes);
    assert_eq!((all, codes(&remarks)), (100, vec![]));
}

#[test]
fn indexes_that_lie_are_not_read() {
    let log = plain_log();
    let mut bytes = [MAGIC.to_vec(), log.definitions()].concat();
    for chunk in chunks("lz4", &log) {
        bytes.extend(chunk);
        bytes.extend(record(7, &[1, 0, 0xff, 0xff, 0xff, 0xff, 1, 2, 3]));
        bytes.extend(record(8, &[0xff; 60]));
    }
    bytes.extend(record(0x0B, &[0xff; 50]));
    bytes.extend(end());
    assert_eq!(samples(&bytes).0, 100);
}

#[test]
fn a_flipped_bit_outside_chunks_is_known_from_the_checksum_of_the_data() {
    let whole = plain_log().bytes(WriteOptions::new().use_chunks(false));
    let (all, remarks) = samples(&whole);
    assert_eq!((all, codes(&remarks)), (100, vec![]));
    let number = 0.49_f64.to_le_bytes();
    let at = whole.windows(8).position(|bytes| bytes == number).unwrap();
    let mut bytes = whole.clone();
    bytes[at] ^= 1;
    let (all, remarks) = samples(&bytes);
    assert_eq!((all, codes(&remarks)), (100, vec![Code::DamagedBytes]));
    assert!(remarks.as_slice()[0].message.contains("numbers may be wrong"), "{remarks:?}");
}

#[test]
fn messages_of_unknown_channels_are_counted() {
    let mut log = plain_log();
    log.add(Channel::states("/odd"), 0..5, |_| vec![1; 30]);
    let without = Log { channels: log.channels[..2].to_vec(), ..Log::default() };
    let bytes = [MAGIC.to_vec(), without.definitions(), chunks("zstd", &log).concat(), end()].concat();
    let (all, remarks) = samples(&bytes);
    assert_eq!((all, count(&remarks, Code::UnknownChannel)), (100, 5));
}

#[test]
fn a_broken_attachment_is_said() {
    let body =
        [&[0; 16][..], &text("a"), &text("b"), &3_u64.to_le_bytes(), b"abc", &9_u32.to_le_bytes()].concat();
    let log = plain_log();
    let bytes =
        [MAGIC.to_vec(), log.definitions(), record(9, &body), chunks("", &log).concat(), end()].concat();
    let recording = read_bytes(&bytes, &ReadOptions::default()).unwrap();
    assert_eq!((recording.attachments.len(), codes(&recording.remarks)), (0, vec![Code::DamagedBytes]));
}

#[test]
fn noise_is_no_log_and_does_no_harm() {
    let mut state = 1_u64;
    let mut noise = |length: usize| -> Vec<u8> {
        (0..length)
            .map(|_| {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                (state >> 56) as u8
            })
            .collect()
    };
    for length in [1, 7, 8, 9, 100, 10_000] {
        assert!(hydrotrace::log::survey_bytes(&noise(length), &ReadOptions::default()).is_err());
        let between = [MAGIC.to_vec(), noise(length), MAGIC.to_vec()].concat();
        let survey = hydrotrace::log::survey_bytes(&between, &ReadOptions::default()).unwrap();
        assert!(survey.recording.is_err());
        assert_eq!(survey.remarks.as_slice().first().map(|r| r.code), Some(Code::NotClosed));
    }
}

#[test]
fn inner_lengths_of_a_chunk_may_say_anything() {
    for length in [u64::MAX, u64::MAX - 9, u64::MAX - 40, 1 << 63, 1 << 32] {
        let log = plain_log();
        let mut chunks = chunks("zstd", &log);
        let place = 9 + 16 + 8 + 4 + 4 + "zstd".len();
        chunks[4][place..place + 8].copy_from_slice(&length.to_le_bytes());
        let (samples, remarks) = samples(&file_of(&log, &chunks));
        assert_eq!(samples, 90, "{remarks:?}");
        chunks.truncate(5);
        let _ = read_bytes(&file_of(&log, &chunks), &ReadOptions::default());
    }
}

#[test]
fn zeros_inside_a_chunk_are_no_records() {
    let log = plain_log();
    let mut chunks = chunks("", &log);
    let mut inside = message_records(&log.messages[40..50]);
    let (third, length) = (inside.len() / 10 * 3, inside.len());
    let end = third + (length - third) / 9 * 9;
    inside[third..].fill(0);
    inside.truncate(end);
    chunks[4] = chunk_with("", inside.len() as u64, 0, &inside);
    let (samples, remarks) = samples(&file_of(&log, &chunks));
    assert_eq!((samples, codes(&remarks)), (93, vec![Code::PartialChunk]));
}

#[test]
fn a_cut_chunk_may_promise_far_more_than_is_left_of_it() {
    let mut log = plain_log();
    log.messages = (0..400).flat_map(|_| log.messages.clone()).collect();
    let inside = message_records(&log.messages);
    let packed = chunk("zstd", &inside);
    assert!(
        inside.len() > (4 << 20) && packed.len() < inside.len() / 1000,
        "{} {}",
        inside.len(),
        packed.len()
    );
    let bytes = [MAGIC.to_vec(), log.definitions(), packed].concat();
    let (samples, remarks) = samples(&bytes[..bytes.len() - 40]);
    assert!(samples > 0 && count(&remarks, Code::PartialChunk) == 1, "{remarks:?}");
}

#[test]
fn recover_keeps_the_messages_of_chunks_whose_checksum_does_not_hold_and_says_where_they_are() {
    let log = plain_log();
    for compression in ["", "lz4", "zstd"] {
        let mut chunks = chunks(compression, &log);
        for chunk in &mut chunks[4..6] {
            // The checksum stands after the record's head, two times and a length.
            chunk[9 + 24] ^= 1;
        }
        let stored = store(&[("damaged.mcap", &file_of(&log, &chunks))]);
        let output = stored.folder.path().join("saved.mcap");
        let saved = hydrotrace::log::recover(&stored.paths, &output).unwrap();
        assert_eq!((saved.messages, saved.doubtful, saved.dropped_blocks), (100, 20, 0), "{compression}");
        let remark = saved.remarks.as_slice().iter().find(|one| one.code == Code::DamagedChunk).unwrap();
        assert_eq!(remark.count, 20);
        let at = MAGIC.len() + log.definitions().len() + chunks[..4].concat().len() + 9;
        let place = format!("chunk 5 (at byte {at}), chunk 6");
        assert!(remark.message.contains(&place), "{}", remark.message);
        let bytes = std::fs::read(&output).unwrap();
        assert_eq!(samples(&bytes).0, 100);
        // A report leaves them out: their numbers may be wrong.
        assert_eq!(samples(&file_of(&log, &chunks)).0, 80);
    }
}
