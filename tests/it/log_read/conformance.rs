//! The conformance suite of the format: six contents in every combination of optional records, 416 files, made here by the
//! specification and equal to the published ones byte for byte.

use hydrotrace::log::{LogFiles, Survey};
use sha2::{Digest, Sha256};

use super::*;

/// SHA-256 over the lines `NAME SHA-256` of all published files, sorted by name.
const PUBLISHED: &str = "eabcfbf8e6525dd4022cb979a3d1793443a31f427cc163be4ddb98e295cd8d01";

/// What a file may have, by the letters in its name.
const FEATURES: [&str; 10] = ["ch", "mx", "st", "rsh", "rch", "ax", "mdx", "chx", "sum", "pad"];

/// What a file holds.
#[derive(Debug, Clone, Copy, Default)]
struct Content {
    name: &'static str,
    /// The channel has a schema.
    schema: bool,
    /// Sequence and log time of the messages.
    messages: &'static [(u32, u64)],
    attachment: bool,
    metadata: bool,
}

const TEN: [(u32, u64); 10] =
    [(0, 0), (1, 2), (2, 1), (3, 3), (4, 3), (5, 5), (6, 4), (7, 7), (8, 8), (9, 9)];

fn contents() -> [Content; 6] {
    let of = |name| Content { name, ..Content::default() };
    [
        of("NoData"),
        Content { messages: &[(10, 2)], ..of("OneSchemalessMessage") },
        Content { schema: true, messages: &[(10, 2)], ..of("OneMessage") },
        Content { attachment: true, ..of("OneAttachment") },
        Content { metadata: true, ..of("OneMetadata") },
        Content { schema: true, messages: &TEN, ..of("TenMessages") },
    ]
}

impl Content {
    /// Whether the suite has a file of this content with these features.
    fn has(&self, with: &dyn Fn(&str) -> bool) -> bool {
        let summarised = ["chx", "rsh", "rch", "mdx", "ax", "st"].iter().any(|name| with(name));
        let lacks = |name: &str, holds: bool| with(name) && !holds;
        let channel = !self.messages.is_empty();
        !(lacks("ax", self.attachment)
            || lacks("mdx", self.metadata)
            || lacks("rsh", self.schema)
            || ["rch", "ch", "chx", "mx"].iter().any(|name| lacks(name, channel))
            || lacks("sum", summarised)
            || ["chx", "mx"].iter().any(|name| lacks(name, with("ch"))))
    }

    /// When a message was published: the first of one file is told from its log time.
    fn published(&self, log_time: u64) -> u64 {
        if self.messages.len() == 1 { 1 } else { log_time }
    }
}

/// Bytes, in the form of the specification: little-endian, texts and arrays after their lengths.
#[derive(Default)]
struct Bytes(Vec<u8>);

impl Bytes {
    fn u16(mut self, value: u16) -> Self {
        self.0.extend(value.to_le_bytes());
        self
    }

    fn u32(mut self, value: u32) -> Self {
        self.0.extend(value.to_le_bytes());
        self
    }

    fn u64(mut self, value: u64) -> Self {
        self.0.extend(value.to_le_bytes());
        self
    }

    fn raw(mut self, value: &[u8]) -> Self {
        self.0.extend(value);
        self
    }

    fn text(self, value: &str) -> Self {
        self.u32(value.len() as u32).raw(value.as_bytes())
    }

    /// Puts a record behind; records of fixed length have no padding.
    fn record(&mut self, opcode: u8, body: Bytes, pad: bool) {
        let pad: &[u8] = if pad { &[1, 0xff, 0xff] } else { &[] };
        let body = body.raw(pad).0;
        let all = std::mem::take(self).raw(&[opcode]).u64(body.len() as u64).raw(&body);
        *self = all;
    }

    fn len(&self) -> u64 {
        self.0.len() as u64
    }
}

const MAGIC: &[u8] = b"\x89MCAP0\r\n";

fn schema() -> Bytes {
    Bytes::default().u16(1).text("Example").text("c").u32(3).raw(&[4, 5, 6])
}

fn channel(content: &Content) -> Bytes {
    let bytes = Bytes::default().u16(1).u16(u16::from(content.schema)).text("example");
    if content.schema { bytes.text("a").u32(14).text("foo").text("bar") } else { bytes.text("text").u32(0) }
}

/// Schema, channel and messages, and where each message lies.
fn data(content: &Content, pad: bool) -> (Bytes, Vec<(u64, u64)>) {
    let (mut bytes, mut places) = (Bytes::default(), Vec::new());
    if content.schema {
        bytes.record(3, schema(), pad);
    }
    if !content.messages.is_empty() {
        bytes.record(4, channel(content), pad);
    }
    for (sequence, log_time) in content.messages {
        places.push((*log_time, bytes.len()));
        let body = Bytes::default().u16(1).u32(*sequence).u64(*log_time).u64(content.published(*log_time));
        bytes.record(5, body.raw(&[1, 2, 3]), false);
    }
    (bytes, places)
}

fn attachment() -> Bytes {
    let body = Bytes::default().u64(2).u64(1).text("myFile").text("application/octet-stream");
    let body = body.u64(3).raw(&[1, 2, 3]);
    let crc = crc32fast::hash(&body.0);
    body.u32(crc)
}

/// One file of the suite.
fn file(content: &Content, with: &dyn Fn(&str) -> bool) -> Vec<u8> {
    let pad = with("pad");
    let mut file = Bytes(MAGIC.to_vec());
    file.record(1, Bytes::default().text("").text(""), pad);
    let times = || content.messages.iter().map(|(_, log_time)| *log_time);
    let ends = [times().min().unwrap_or(0), times().max().unwrap_or(0)];
    let at = file.len();
    // Indexes of the summary: attachment, metadata, chunk.
    let mut indexes: [Option<Bytes>; 3] = [None, None, None];
    if content.attachment {
        file.record(9, attachment(), pad);
        let index = Bytes::default().u64(at).u64(file.len() - at).u64(2).u64(1).u64(3).text("myFile");
        indexes[0] = with("ax").then(|| index.text("application/octet-stream"));
    }
    if content.metadata {
        file.record(12, Bytes::default().text("myMetadata").u32(14).text("foo").text("bar"), pad);
        indexes[1] = with("mdx").then(|| Bytes::default().u64(at).u64(file.len() - at).text("myMetadata"));
    }
    if with("ch") {
        let (records, places) = data(content, false);
        let size = records.len();
        let body = Bytes::default().u64(ends[0]).u64(ends[1]).u64(size).u32(crc32fast::hash(&records.0));
        file.record(6, body.text("").u64(size).raw(&records.0), false);
        let (length, index_at) = (file.len() - at, file.len());
        if with("mx") {
            let body = Bytes::default().u16(1).u32(16 * places.len() as u32);
            file.record(7, places.iter().fold(body, |body, (time, at)| body.u64(*time).u64(*at)), pad);
        }
        let index = Bytes::default().u64(ends[0]).u64(ends[1]).u64(at).u64(length);
        let index = if with("mx") { index.u32(10).u16(1).u64(index_at) } else { index.u32(0) };
        let index = index.u64(file.len() - index_at).text("").u64(size).u64(size);
        indexes[2] = with("chx").then_some(index);
    } else {
        file = file.raw(&data(content, pad).0.0);
    }
    let crc = crc32fast::hash(&file.0);
    file.record(15, Bytes::default().u32(crc), false);
    summary(file, content, with, (ends, indexes))
}

/// The file with its summary, offsets and footer.
fn summary(
    mut file: Bytes,
    content: &Content,
    with: &dyn Fn(&str) -> bool,
    (ends, [ax, mdx, chx]): ([u64; 2], [Option<Bytes>; 3]),
) -> Vec<u8> {
    let pad = with("pad");
    let start = file.len();
    let count = content.messages.len() as u64;
    let statistics = || {
        let one = |holds: bool| u32::from(holds);
        let bytes = Bytes::default().u64(count).u16(u16::from(content.schema)).u32(one(count > 0));
        let bytes = bytes.u32(one(content.attachment)).u32(one(content.metadata)).u32(one(with("ch")));
        let bytes = bytes.u64(ends[0]).u64(ends[1]);
        if count > 0 { bytes.u32(10).u16(1).u64(count) } else { bytes.u32(0) }
    };
    let groups = [
        (3, with("rsh").then(schema)),
        (4, with("rch").then(|| channel(content))),
        (11, with("st").then(statistics)),
        (13, mdx),
        (10, ax),
        (8, chx),
    ];
    let mut offsets = Bytes::default();
    for (opcode, body) in groups {
        let Some(body) = body else { continue };
        let at = file.len();
        file.record(opcode, body, pad);
        offsets.record(14, Bytes::default().raw(&[opcode]).u64(at).u64(file.len() - at), pad);
    }
    let offset_at = if with("sum") { file.len() } else { 0 };
    let summary_at = if file.len() > start { start } else { 0 };
    if with("sum") {
        file = file.raw(&offsets.0);
    }
    let footer = Bytes::default().u64(summary_at).u64(offset_at);
    let head = Bytes::default().raw(&[2]).u64(20).raw(&footer.0);
    let crc = crc32fast::hash(&Bytes::default().raw(&file.0[start as usize..]).raw(&head.0).0);
    file.record(2, footer.u32(crc), false);
    file.raw(MAGIC).0
}

/// All files with their names and contents.
fn suite() -> Vec<(String, Content, Vec<u8>)> {
    let mut all = Vec::new();
    for content in contents() {
        for set in 0..1_u32 << FEATURES.len() {
            let with =
                |name: &str| FEATURES.iter().enumerate().any(|(k, own)| *own == name && set >> k & 1 == 1);
            if content.has(&with) {
                let mut names: Vec<&str> = FEATURES.into_iter().filter(|name| with(name)).collect();
                names.sort_unstable();
                let name = [&[content.name], &names[..]].concat().join("-");
                all.push((name, content, file(&content, &with)));
            }
        }
    }
    all.sort_by(|a, b| a.0.cmp(&b.0));
    all
}

fn hex(digest: impl AsRef<[u8]>) -> String {
    digest.as_ref().iter().map(|byte| format!("{byte:02x}")).collect()
}

#[test]
fn the_files_of_the_suite_are_the_published_ones_and_are_read_without_a_false_remark() {
    let suite = suite();
    assert_eq!(suite.len(), 416);
    let line =
        |(name, _, bytes): &(String, Content, Vec<u8>)| format!("{name} {}\n", hex(Sha256::digest(bytes)));
    let lines: String = suite.iter().map(line).collect();
    if let Some(path) = std::env::var_os("CONFORMANCE_LINES") {
        std::fs::write(path, &lines).unwrap();
    }
    for (name, content, bytes) in suite {
        let stored = store(&[("run.mcap", &bytes)]);
        let files = LogFiles::open(&stored.paths).unwrap();
        let whole = files.survey(&ReadOptions::default()).unwrap();
        let counted = |survey: &Survey| survey.topics.iter().map(|topic| topic.messages).sum::<u64>();
        assert!(whole.remarks.is_empty() && whole.files[0].closed, "{name}: {:?}", whole.remarks);
        assert_eq!(counted(&whole), content.messages.len() as u64, "{name}");
        assert_eq!(whole.attachments.len(), usize::from(content.attachment), "{name}");
        if let Some(listed) = files.survey_by_index() {
            assert_eq!(counted(&listed), counted(&whole), "{name} by its index");
            assert!(listed.remarks.is_empty(), "{name}: {:?}", listed.remarks);
        }
    }
    assert_eq!(hex(Sha256::digest(&lines)), PUBLISHED);
}

/// The files that the crate `mcap` is tested with, from where the package registry put its source.
#[test]
fn the_files_of_the_crate_mcap_have_the_remarks_that_are_true_of_them() {
    let tree = std::process::Command::new(env!("CARGO"))
        .args(["metadata", "--format-version", "1"])
        .current_dir(crate::support::root())
        .output()
        .unwrap();
    let tree: serde_json::Value = serde_json::from_slice(&tree.stdout).unwrap();
    let mut packages = tree["packages"].as_array().unwrap().iter();
    let own = packages.find(|package| package["name"] == "mcap").unwrap();
    let folder = std::path::Path::new(own["manifest_path"].as_str().unwrap()).with_file_name("tests/data");
    for (name, topics, messages, remarks) in [
        ("chunk_not_closed.mcap", 0, 0, &[Code::NotClosed, Code::PartialChunk][..]),
        ("compressed.mcap", 2, 826, &[]),
        ("uncompressed.mcap", 2, 826, &[]),
        // Its messages are of channels that it does not have.
        ("zstd_chunk_with_padding.mcap", 0, 0, &[Code::UnknownChannel]),
    ] {
        let found = hydrotrace::log::survey(&[folder.join(name)], &ReadOptions::default()).unwrap();
        assert_eq!(codes(&found.remarks), remarks, "{name}: {:?}", found.remarks);
        assert_eq!(found.topics.len(), topics, "{name}");
        assert_eq!(found.topics.iter().map(|topic| topic.messages).sum::<u64>(), messages, "{name}");
    }
}
