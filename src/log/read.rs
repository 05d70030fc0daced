//! Reads all joint topics of a recording, in parallel over its blocks, in the order of the file.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
    sync::Arc,
};

use super::{
    LogError, bag,
    channel::{Channel, Decoder, Definitions},
    decode::LayoutCache,
    file::{Layout, MappedFile, MessageRecord, scan},
    overlap,
    parallel::read_blocks,
    source::{Form, Plans, Role, Selector, Spec, Table, Versioned},
};
use crate::remark::{Code, Remarks};

/// What a topic holds, whether it is read or not.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct TopicCount {
    pub(super) topic: String,
    pub(super) type_name: String,
    pub(super) encoding: String,
    pub(super) messages: u64,
    pub(super) undecodable: u64,
    pub(super) first_error: Option<String>,
    pub(super) first_log_ns: u64,
    pub(super) last_log_ns: u64,
    /// Why messages of it were not read, and how many.
    pub(super) problem: Option<String>,
    pub(super) unread: u64,
}

/// What was read of one topic.
#[derive(Debug, Clone)]
pub(super) enum Content {
    Table(Box<Table>),
    Plans(Plans),
    Versioned(Versioned),
}

impl Content {
    pub(super) fn new(spec: &Spec, joints: &[String]) -> Self {
        match spec.form {
            Form::Plans => Self::Plans(Plans::default()),
            Form::Versioned | Form::VersionedNames => Self::Versioned(Versioned::default()),
            form => Self::Table(Box::new(Table::new(form, &spec.fields, joints))),
        }
    }

    pub(super) fn read(
        &mut self,
        decoder: &Decoder,
        cache: &mut LayoutCache,
        message: &MessageRecord<'_>,
    ) -> Result<(), String> {
        macro_rules! read {
            ($sink:expr) => {{
                match decoder {
                    Decoder::Program(program) => {
                        program.run(message.data, cache, $sink).map_err(|e| e.to_string())?
                    }
                    Decoder::Tree(tree) => tree.run(message.data, $sink)?,
                }
                $sink.commit(message.publish_time_ns, message.log_time_ns);
            }};
        }
        match self {
            Self::Table(table) => {
                let table = &mut **table;
                read!(table);
            }
            Self::Plans(plans) => read!(plans),
            Self::Versioned(versioned) => read!(versioned),
        }
        Ok(())
    }

    /// Rows of a table.
    pub(super) fn rows(&self) -> usize {
        if let Self::Table(table) = self { table.len() } else { 0 }
    }

    pub(super) fn append(&mut self, other: &mut Self) {
        match (self, other) {
            (Self::Table(mine), Self::Table(theirs)) => mine.append(theirs),
            (Self::Plans(mine), Self::Plans(theirs)) => mine.append(theirs),
            (Self::Versioned(mine), Self::Versioned(theirs)) => mine.append(theirs),
            _ => {}
        }
    }
}

/// One topic that holds joints, with what was read of it.
#[derive(Debug, Clone)]
pub(super) struct Source {
    /// Index into the topics.
    pub(super) topic: usize,
    pub(super) content: Content,
    /// Files that it was read from, and how many rows came before each.
    pub(super) parts: Vec<(usize, usize)>,
}

/// Everything that reading yields.
#[derive(Debug, Default)]
pub(super) struct Extracted {
    pub(super) files: Vec<FileInfo>,
    pub(super) topics: Vec<TopicCount>,
    pub(super) sources: Vec<Source>,
    pub(super) attachments: Vec<Attachment>,
    pub(super) metadata: BTreeMap<String, BTreeMap<String, String>>,
    pub(super) remarks: Remarks,
}

/// A file of the recording.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct FileInfo {
    /// Its name without the path.
    pub name: String,
    /// Its size.
    pub bytes: u64,
    /// Chunks, or runs of messages outside chunks.
    pub blocks: usize,
    /// Whether the recorder ended it properly.
    pub closed: bool,
}

/// A file stored inside a log.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Attachment {
    /// Its name.
    pub name: String,
    /// Its media type.
    pub media_type: String,
    /// Its content.
    pub data: Vec<u8>,
}

/// What to do with one channel of one file.
pub(super) struct Route {
    pub(super) topic: usize,
    pub(super) read: Option<(usize, Decoder)>,
    /// Its messages may hold joints but cannot be read.
    pub(super) unreadable: bool,
}

/// Maps, scans and reads the files; `selectors` are the fields that the caller named, `joints`
/// the names for topics that carry none.
pub(super) fn extract(
    paths: &[PathBuf],
    selectors: &[(Role, Selector)],
    joints: &[String],
) -> Result<Extracted, LogError> {
    let mut remarks = Remarks::default();
    // A bag says the order of its parts; of single files the recorder's clock does.
    let ordered = paths.iter().any(|path| path.is_dir());
    let paths = bag::recording_files(paths, &mut remarks)?;
    let maps = paths
        .iter()
        .map(|path| MappedFile::open(path).map_err(LogError::file("open", path)))
        .collect::<Result<Vec<_>, _>>()?;
    let files: Vec<(&Path, &[u8])> = paths.iter().zip(&maps).map(|(path, map)| (&**path, &**map)).collect();
    extract_bytes(&files, ordered, selectors, joints, remarks)
}

/// The same for files in memory, in order of time if they are not `ordered`.
pub(super) fn extract_bytes(
    files: &[(&Path, &[u8])],
    ordered: bool,
    selectors: &[(Role, Selector)],
    joints: &[String],
    remarks: Remarks,
) -> Result<Extracted, LogError> {
    let mut out = Extracted { remarks, ..Extracted::default() };
    let mut layouts = Vec::with_capacity(files.len());
    for (path, bytes) in files {
        layouts.push((path, bytes, scan(bytes).ok_or_else(|| not_mcap(path, bytes))?));
    }
    if !ordered {
        layouts.sort_by_cached_key(|(path, _, layout)| (overlap::begins_ns(layout), **path));
    }
    for (path, bytes, layout) in &layouts {
        describe(path, bytes, layout, &mut out);
    }
    let layouts: Vec<Layout<'_>> = layouts.into_iter().map(|(_, _, layout)| layout).collect();
    let before = out.remarks.clone();
    let unknown = read_layouts(&layouts, selectors, joints, false, &mut out);
    if unknown > 0 && layouts.iter().any(|layout| layout.channels_complete) {
        // A summary that leaves out channels is no summary: look for them in the chunks.
        out.topics.clear();
        out.sources.clear();
        out.remarks = before;
        read_layouts(&layouts, selectors, joints, true, &mut out);
    }
    finish(&mut out);
    Ok(out)
}

/// Reads all blocks; returns how many messages are of no known channel.
fn read_layouts(
    layouts: &[Layout<'_>],
    selectors: &[(Role, Selector)],
    joints: &[String],
    look_inside: bool,
    out: &mut Extracted,
) -> u64 {
    let mut known = Known::default();
    let mut work = Vec::new();
    for (file, layout) in layouts.iter().enumerate() {
        let channels = Definitions::gather(layout, look_inside).plan(selectors);
        let routes = Arc::new(routes(channels, joints, &mut known, out));
        work.extend(layout.blocks.iter().map(|block| (*block, routes.clone(), file)));
    }
    read_blocks(&work, &known.specs, joints, out)
}

pub(super) fn not_mcap(path: &Path, bytes: &[u8]) -> LogError {
    if is_table(path, bytes) {
        return LogError::IsTable { path: path.to_owned() };
    }
    let start: Vec<String> = bytes.iter().take(8).map(|byte| format!("{byte:02X}")).collect();
    let fix = match bytes {
        [] => "the file is empty",
        [b'#', b'R', b'O', b'S', ..] => "convert the ROS 1 bag first, for example with rosbags-convert",
        [b'S', b'Q', b'L', b'i', ..] => {
            "convert the SQLite bag first, with `ros2 bag convert` to MCAP storage"
        }
        [0x28, 0xB5, 0x2F, 0xFD, ..] => "decompress it first, with `zstd -d`",
        _ => "give an .mcap recording or a ROS 2 bag directory",
    };
    let found = if start.is_empty() { "nothing".to_owned() } else { start.join(" ") };
    LogError::NotMcap { path: path.to_owned(), found, fix }
}

/// Whether bytes are text whose first lines are split alike, or text of a file named as a table.
fn is_table(path: &Path, bytes: &[u8]) -> bool {
    const LOOK: usize = 4096;
    const LINES: usize = 3;
    let text = String::from_utf8_lossy(bytes.get(..LOOK).unwrap_or(bytes));
    if text.trim().is_empty() || text.chars().any(|c| c.is_control() && !c.is_whitespace()) {
        return false;
    }
    let named = path
        .extension()
        .is_some_and(|ending| ["csv", "tsv"].iter().any(|one| ending.eq_ignore_ascii_case(one)));
    let alike = |separator: char| {
        let lines = text.lines().filter(|line| !line.trim().is_empty() && !line.starts_with('#')).take(LINES);
        let counts: Vec<usize> = lines.map(|line| line.matches(separator).count()).collect();
        counts.len() == LINES && counts[0] > 0 && counts.iter().all(|count| *count == counts[0])
    };
    named || [';', ',', '\t'].into_iter().any(alike)
}

fn describe(path: &Path, bytes: &[u8], layout: &Layout<'_>, out: &mut Extracted) {
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    describe_damage(&name, layout, &mut out.remarks);
    ::log::info!("opened {}: {} bytes in {} blocks", path.display(), bytes.len(), layout.blocks.len());
    out.files.push(FileInfo {
        name,
        bytes: bytes.len() as u64,
        blocks: layout.blocks.len(),
        closed: !layout.damage.not_closed,
    });
    out.attachments.extend(layout.attachments.iter().map(|a| Attachment {
        name: a.name.clone(),
        media_type: a.media_type.clone(),
        data: a.data.to_vec(),
    }));
    for one in &layout.metadata {
        out.metadata.entry(one.name.clone()).or_default().extend(one.entries.clone());
    }
}

/// Remarks on the outer structure of a file.
pub(super) fn describe_damage(name: &str, layout: &Layout<'_>, remarks: &mut Remarks) {
    let damage = layout.damage;
    remarks.add(
        Code::NotClosed,
        u64::from(damage.not_closed),
        format!(
            "{name} was not closed (power loss, or a kill while recording); read up to its last whole message"
        ),
    );
    remarks.add(
        Code::DamagedBytes,
        damage.skipped_bytes,
        format!("bytes of {name} that are no record, skipped"),
    );
    remarks.add(
        Code::DamagedBytes,
        damage.broken_attachments,
        format!("attachments of {name} with a wrong checksum, dropped"),
    );
    remarks.add(
        Code::DamagedBytes,
        u64::from(damage.broken_summary),
        format!("summary of {name} with a wrong checksum, not used"),
    );
    remarks.add(
        Code::DamagedBytes,
        u64::from(damage.broken_data),
        format!("data of {name} with a wrong checksum and no chunks to tell where; numbers may be wrong"),
    );
}

/// Topics by name and type, and the sources of each.
#[derive(Default)]
struct Known {
    topics: BTreeMap<(String, String), usize>,
    sources: BTreeMap<usize, Vec<usize>>,
    specs: Vec<Spec>,
}

/// Joins the channels of a file to the topics and sources of the recording.
fn routes(
    channels: BTreeMap<u16, Channel>,
    joints: &[String],
    known: &mut Known,
    out: &mut Extracted,
) -> BTreeMap<u16, Route> {
    let mut routes = BTreeMap::new();
    for (id, channel) in channels {
        let name = (channel.topic.clone(), channel.type_name.clone());
        let topic = *known.topics.entry(name).or_insert_with(|| {
            out.topics.push(TopicCount {
                topic: channel.topic,
                type_name: channel.type_name,
                encoding: channel.encoding,
                ..TopicCount::default()
            });
            out.topics.len() - 1
        });
        let unreadable = channel.problem.is_some();
        if out.topics[topic].problem.is_none() {
            out.topics[topic].problem = channel.problem;
        }
        let read = channel.reader.map(|(spec, decoder)| {
            let of_topic = known.sources.entry(topic).or_default();
            let same = of_topic.iter().copied().find(|&source| known.specs[source] == *spec);
            let source = same.unwrap_or_else(|| {
                out.sources.push(Source { topic, content: Content::new(&spec, joints), parts: Vec::new() });
                known.specs.push((*spec).clone());
                of_topic.push(known.specs.len() - 1);
                known.specs.len() - 1
            });
            (source, decoder)
        });
        routes.insert(id, Route { topic, read, unreadable });
    }
    routes
}

/// Turns counts into remarks, and versioned values into tables.
fn finish(out: &mut Extracted) {
    for topic in &out.topics {
        if let Some(problem) = &topic.problem {
            out.remarks.add(
                Code::UnreadableSchema,
                topic.unread.max(1),
                format!("messages of {} ({}) skipped: {problem}", topic.topic, topic.type_name),
            );
        }
        if let Some(error) = &topic.first_error {
            out.remarks.add(
                Code::UndecodableMessage,
                topic.undecodable,
                format!(
                    "messages of {} that do not fit their schema, skipped; the first: {error}",
                    topic.topic
                ),
            );
        }
    }
    let (halves, mut sources): (Vec<_>, Vec<_>) = std::mem::take(&mut out.sources)
        .into_iter()
        .partition(|s| matches!(s.content, Content::Versioned(_)));
    let stem =
        |source: &Source| out.topics[source.topic].topic.rsplit_once('/').map(|(stem, _)| stem.to_owned());
    let mut by_stem: BTreeMap<_, Vec<&Versioned>> = BTreeMap::new();
    for half in &halves {
        if let Content::Versioned(versioned) = &half.content
            && versioned.has_names()
        {
            by_stem.entry(stem(half)).or_default().push(versioned);
        }
    }
    for half in &halves {
        if let Content::Versioned(values) = &half.content
            && let Some(table) = by_stem.get(&stem(half)).and_then(|names| values.to_table(names))
        {
            let content = Content::Table(Box::new(table));
            sources.push(Source { topic: half.topic, content, parts: Vec::new() });
        }
    }
    out.sources = sources;
}
