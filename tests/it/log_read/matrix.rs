//! Kinds of damage by codec and reader: how many of the messages that were written each gives back.
//! `PYTHON=target/peers/bin/python cargo test --test it matrix -- --nocapture` prints the table of docs/reliability.md,
//! with the reader of the Python package `mcap` too.

use std::{
    collections::BTreeMap,
    panic::{AssertUnwindSafe, catch_unwind},
    path::Path,
    process::Command,
};

use mcap::{Compression, MessageStream, Summary, WriteOptions, read::Options};

use super::{file::*, *};

/// A message as it is told from others, and how often it was given.
type Messages = BTreeMap<(u64, String, u32), usize>;

type Spoil = fn(&mut Vec<u8>);

const CHUNK: u8 = 6;
const DATA_END: u8 = 0x0F;

/// The first byte of record number `nth` of a kind.
fn find(bytes: &[u8], opcode: u8, nth: usize) -> usize {
    let length = |at: usize| u64::from_le_bytes(bytes[at + 1..at + 9].try_into().unwrap()) as usize;
    let records = std::iter::successors(Some(MAGIC.len()), |at| Some(at + 9 + length(*at)));
    records.take_while(|at| at + 9 < bytes.len()).filter(|at| bytes[*at] == opcode).nth(nth).unwrap()
}

/// A byte half way from the fifth chunk to the sixth: in its messages, or of a small one in the index that follows it.
fn inside(bytes: &[u8]) -> usize {
    usize::midpoint(find(bytes, CHUNK, 4), find(bytes, CHUNK, 5))
}

const DAMAGE: [(&str, Spoil); 18] = [
    ("none", |_| ()),
    ("cut at half", |bytes| bytes.truncate(bytes.len() / 2)),
    ("cut in the last chunk", |bytes| bytes.truncate(find(bytes, DATA_END, 0) - 400)),
    ("cut in the summary", |bytes| bytes.truncate(find(bytes, DATA_END, 0) + 200)),
    ("last byte gone", |bytes| bytes.truncate(bytes.len() - 1)),
    ("bit flipped half way to the next chunk", |bytes| {
        let at = inside(bytes);
        bytes[at] ^= 4;
    }),
    ("checksum of a chunk wrong", |bytes| {
        let at = find(bytes, CHUNK, 4);
        bytes[at + 9 + 24] ^= 1;
    }),
    ("512 bytes zero half way to the next chunk", |bytes| {
        let at = inside(bytes);
        bytes[at..at + 512].fill(0);
    }),
    ("start of a chunk zero", |bytes| {
        let at = find(bytes, CHUNK, 4);
        bytes[at..at + 40].fill(0);
    }),
    ("summary and footer gone", |bytes| bytes.truncate(find(bytes, DATA_END, 0))),
    ("footer zero", |bytes| {
        let end = bytes.len();
        bytes[end - 28..end - 8].fill(0xFF);
    }),
    ("length of a chunk too large", |bytes| {
        let at = find(bytes, CHUNK, 4);
        bytes[at + 3] ^= 0x10;
    }),
    ("length of a chunk too small", |bytes| {
        let at = find(bytes, CHUNK, 4);
        bytes[at + 1..at + 3].copy_from_slice(&[60, 0]);
    }),
    ("100 bytes doubled half way to the next chunk", |bytes| {
        let at = inside(bytes);
        let twice = bytes[at..at + 100].to_vec();
        bytes.splice(at..at, twice);
    }),
    ("100 bytes gone half way to the next chunk", |bytes| {
        let at = inside(bytes);
        drop(bytes.drain(at..at + 100));
    }),
    ("two chunks exchanged", |bytes| {
        let [a, b, c] = [4, 5, 6].map(|nth| find(bytes, CHUNK, nth));
        bytes[a..c].rotate_left(b - a);
    }),
    ("a schema of the summary broken", |bytes| {
        let end = find(bytes, DATA_END, 0) + 13;
        let at = end + find(&[MAGIC, &bytes[end..]].concat(), 3, 0) - 8;
        bytes[at + 11..at + 15].fill(0xFF);
    }),
    ("first chunk unreadable", |bytes| {
        let at = find(bytes, CHUNK, 0);
        bytes[at + 60..at + 200].fill(0xA5);
    }),
];

fn add(into: &mut Messages, topic: &str, log_time: u64, crc: u32) {
    *into.entry((log_time, topic.to_owned(), crc)).or_default() += 1;
}

fn collect<'a>(mut messages: impl Iterator<Item = mcap::McapResult<mcap::Message<'a>>>) -> Messages {
    let mut all = Messages::new();
    // Some readers go on after an error, some repeat it, and some panic: then the stream is at its end.
    for _ in 0..100_000 {
        let Ok(Some(next)) = catch_unwind(AssertUnwindSafe(|| messages.next())) else { break };
        let Ok(message) = next else { continue };
        add(&mut all, &message.channel.topic, message.log_time, crc32fast::hash(&message.data));
    }
    all
}

fn streamed(bytes: &[u8], checked: bool) -> Messages {
    let mut options = Options::IgnoreEndMagic.into();
    if checked {
        options = Options::ValidateChunkCrcs.into();
    }
    MessageStream::new_with_options(bytes, options).map(collect).unwrap_or_default()
}

/// As a reader does that goes by the index of the summary.
fn indexed(bytes: &[u8]) -> Messages {
    let Ok(Some(summary)) = Summary::read(bytes) else { return Messages::new() };
    let chunks = summary.chunk_indexes.iter().filter_map(|chunk| summary.stream_chunk(bytes, chunk).ok());
    collect(chunks.flat_map(|messages| messages.take(100_000)))
}

fn recovered(path: &Path) -> Messages {
    let saved = path.with_extension("saved");
    match hydrotrace::log::recover(&[path.to_owned()], &saved) {
        Ok(_) => streamed(&std::fs::read(saved).unwrap(), true),
        Err(_) => Messages::new(),
    }
}

/// Messages that `report` reads.
fn reported(path: &Path) -> usize {
    let survey = hydrotrace::log::survey(&[path.to_owned()], &ReadOptions::default());
    survey.map_or(0, |survey| survey.topics.iter().map(|topic| topic.messages).sum::<u64>() as usize)
}

/// By its index and as a stream; empty without `PYTHON`.
fn by_python(path: &Path) -> Vec<Messages> {
    let Some(python) = std::env::var_os("PYTHON") else { return Vec::new() };
    let script = crate::support::root().join("tests/peers/read_messages.py");
    let run = Command::new(python).arg(script).arg(path).output().unwrap();
    let all: Vec<Vec<(u64, String, u32)>> = serde_json::from_slice(&run.stdout).unwrap();
    let messages = |all: Vec<(u64, String, u32)>| {
        let mut messages = Messages::new();
        all.iter().for_each(|(at, topic, crc)| add(&mut messages, topic, *at, *crc));
        messages
    };
    all.into_iter().map(messages).collect()
}

/// How many messages are as they were written.
fn sound(found: &Messages, written: &Messages) -> usize {
    written.iter().map(|(message, count)| found.get(message).map_or(0, |found| *found.min(count))).sum()
}

#[test]
fn recover_gives_every_message_that_another_reader_gives() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let mut log = Log::default();
    let noise = |k: i64| plan(k).iter().map(|q| (1e4 * q).sin()).collect::<Vec<f64>>();
    for topic in ["/planned/joint_states", "/joint_states"] {
        add_joint_state(&mut log, topic, noise);
    }
    log.messages.sort_by_key(|message| message.log_ns);
    let mut table = vec![Vec::new(); DAMAGE.len()];
    for (codec, compression) in
        [("none", None), ("lz4", Some(Compression::Lz4)), ("zstd", Some(Compression::Zstd))]
    {
        let options = WriteOptions::new().compression(compression).chunk_size(Some(900));
        let whole = log.bytes(options);
        let written = streamed(&whole, true);
        for ((damage, spoil), row) in DAMAGE.into_iter().zip(&mut table) {
            let mut bytes = whole.clone();
            spoil(&mut bytes);
            std::fs::write(&path, &bytes).unwrap();
            let ours = recovered(&path);
            let peers = [streamed(&bytes, false), streamed(&bytes, true), indexed(&bytes)];
            let peers: Vec<Messages> = peers.into_iter().chain(by_python(&path)).collect();
            let cell = |found: &Messages| match found.values().sum::<usize>() - sound(found, &written) {
                0 => sound(found, &written).to_string(),
                wrong => format!("{} + {wrong} wrong", sound(found, &written)),
            };
            let counts = std::iter::once(reported(&path).to_string());
            row.push(counts.chain(std::iter::once(&ours).chain(&peers).map(cell)).collect::<Vec<String>>());
            for found in &peers {
                let lost =
                    written.keys().filter(|m| found.contains_key(*m) && !ours.contains_key(*m)).count();
                assert_eq!(lost, 0, "{damage}, {codec}: recover loses what another reader gives: {row:?}");
            }
        }
        println!("{codec}: {} messages in {} bytes", log.messages.len(), whole.len());
    }
    for ((damage, _), codecs) in DAMAGE.iter().zip(&table) {
        let alike = |reader: usize| codecs.iter().all(|cells| cells[reader] == codecs[0][reader]);
        let cell = |reader: usize| {
            let all: Vec<&str> = codecs.iter().map(|cells| cells[reader].as_str()).collect();
            if alike(reader) { all[0].to_owned() } else { all.join(" / ") }
        };
        println!("| {damage} | {} |", (0..codecs[0].len()).map(cell).collect::<Vec<_>>().join(" | "));
    }
}
