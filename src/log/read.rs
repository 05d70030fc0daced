//! Reads all joint topics of a recording, in parallel over its blocks, in the order of the file.

use std::{
    collections::BTreeMap,
    path::PathBuf,
    sync::{
        Condvar, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicUsize, Ordering},
    },
};

use super::{
    LogError, bag,
    channel::{Channel, Decoder, Definitions},
    file::{Block, Blocks, Layout, Loss, MappedFile, MessageRecord, Opcode, records, scan},
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
    pub(super) problem: Option<String>,
}

/// What was read of one topic.
#[derive(Debug, Clone)]
pub(super) enum Content {
    Table(Table),
    Plans(Plans),
    Versioned(Versioned),
}

impl Content {
    fn new(spec: &Spec, joints: &[String]) -> Self {
        match spec.form {
            Form::Plans => Self::Plans(Plans::default()),
            Form::Versioned | Form::VersionedNames => Self::Versioned(Versioned::default()),
            form => Self::Table(Table::new(form, &spec.fields, joints)),
        }
    }

    fn read(&mut self, decoder: &Decoder, message: &MessageRecord<'_>) -> Result<(), String> {
        macro_rules! read {
            ($sink:expr) => {{
                match decoder {
                    Decoder::Program(program) => {
                        program.run(message.data, $sink).map_err(|e| e.to_string())?
                    }
                    Decoder::Tree(tree) => tree.run(message.data, $sink)?,
                }
                $sink.commit(message.publish_time_ns, message.log_time_ns);
            }};
        }
        match self {
            Self::Table(table) => read!(table),
            Self::Plans(plans) => read!(plans),
            Self::Versioned(versioned) => read!(versioned),
        }
        Ok(())
    }

    fn append(&mut self, other: &mut Self) {
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
#[derive(Debug, Clone, PartialEq, Eq)]
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
struct Route {
    topic: usize,
    read: Option<(usize, Decoder)>,
}

/// Maps, scans and reads the files; `selectors` are the fields that the caller named, `joints`
/// the names for topics that carry none.
pub(super) fn extract(
    paths: &[PathBuf],
    selectors: &[(Role, Selector)],
    joints: &[String],
) -> Result<Extracted, LogError> {
    let mut out = Extracted::default();
    let paths = bag::files(paths, &mut out.remarks)?;
    let maps = paths
        .iter()
        .map(|path| MappedFile::open(path).map_err(LogError::file("open", path)))
        .collect::<Result<Vec<_>, _>>()?;
    let mut layouts = Vec::with_capacity(maps.len());
    for (path, map) in paths.iter().zip(&maps) {
        let layout = scan(map).ok_or_else(|| not_mcap(path, map))?;
        describe(path, map, &layout, &mut out);
        layouts.push(layout);
    }
    let mut specs: Vec<Spec> = Vec::new();
    let mut work = Vec::new();
    for layout in &layouts {
        let routes = routes(&Definitions::gather(layout).plan(selectors), joints, &mut specs, &mut out);
        let routes = std::sync::Arc::new(routes);
        work.extend(layout.blocks.iter().map(|block| (*block, routes.clone())));
    }
    read_blocks(&work, &specs, joints, &mut out);
    finish(&mut out);
    Ok(out)
}

fn not_mcap(path: &std::path::Path, bytes: &[u8]) -> LogError {
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

fn describe(path: &std::path::Path, bytes: &[u8], layout: &Layout<'_>, out: &mut Extracted) {
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let damage = layout.damage;
    if damage.not_closed {
        out.remarks.add(
            Code::NotClosed,
            1,
            format!("{name} was not closed (power loss or kill while recording); read up to its last whole message"),
        );
    }
    out.remarks.add(
        Code::DamagedBytes,
        damage.skipped_bytes,
        format!("bytes of {name} that are no record, skipped"),
    );
    out.remarks.add(
        Code::DamagedBytes,
        damage.broken_attachments,
        format!("attachments of {name} with a wrong checksum"),
    );
    out.files.push(FileInfo {
        name,
        bytes: bytes.len() as u64,
        blocks: layout.blocks.len(),
        closed: !damage.not_closed,
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

/// Joins the channels of a file to the topics and sources of the recording.
fn routes(
    channels: &BTreeMap<u16, Channel>,
    joints: &[String],
    specs: &mut Vec<Spec>,
    out: &mut Extracted,
) -> BTreeMap<u16, Route> {
    let mut routes = BTreeMap::new();
    for (&id, channel) in channels {
        let same = |t: &TopicCount| t.topic == channel.topic && t.type_name == channel.type_name;
        let topic = out.topics.iter().position(same).unwrap_or_else(|| {
            out.topics.push(TopicCount {
                topic: channel.topic.clone(),
                type_name: channel.type_name.clone(),
                encoding: channel.encoding.clone(),
                problem: channel.problem.clone(),
                ..TopicCount::default()
            });
            out.topics.len() - 1
        });
        let read = channel.reader.as_ref().map(|(spec, decoder)| {
            let known =
                out.sources.iter().zip(specs.iter()).position(|(s, known)| s.topic == topic && known == spec);
            let source = known.unwrap_or_else(|| {
                out.sources.push(Source { topic, content: Content::new(spec, joints) });
                specs.push(spec.clone());
                specs.len() - 1
            });
            (source, decoder.clone())
        });
        routes.insert(id, Route { topic, read });
    }
    routes
}

type Work<'a> = (Block<'a>, std::sync::Arc<BTreeMap<u16, Route>>);

/// What one block yields; emptied and reused.
struct Piece {
    contents: Vec<Content>,
    topics: Vec<TopicCount>,
    unknown: u64,
    loss: Loss,
    messages: u64,
}

struct Progress<'a> {
    next: usize,
    waiting: BTreeMap<usize, Piece>,
    spare: Vec<Piece>,
    out: &'a mut Extracted,
}

/// Decodes blocks on all threads and appends them in the order of the file, so that the result
/// does not depend on the number of threads.
fn read_blocks(work: &[Work<'_>], specs: &[Spec], joints: &[String], out: &mut Extracted) {
    let topics = out.topics.len();
    let fresh = || Piece {
        contents: specs.iter().map(|spec| Content::new(spec, joints)).collect(),
        topics: vec![TopicCount::default(); topics],
        unknown: 0,
        loss: Loss::Nothing,
        messages: 0,
    };
    let threads = rayon::current_num_threads();
    let counter = AtomicUsize::new(0);
    let progress = Mutex::new(Progress { next: 0, waiting: BTreeMap::new(), spare: Vec::new(), out });
    let moved = Condvar::new();
    rayon::broadcast(|_| {
        let mut blocks = Blocks::new();
        loop {
            let index = counter.fetch_add(1, Ordering::Relaxed);
            let Some((block, routes)) = work.get(index) else { return };
            let mut piece = lock(&progress).spare.pop().unwrap_or_else(fresh);
            read_block(&mut blocks, *block, routes, &mut piece);
            let mut state = lock(&progress);
            // A thread may run ahead of the slowest by a few blocks only: memory stays bounded.
            while index > state.next + 4 * threads {
                state = moved.wait(state).unwrap_or_else(PoisonError::into_inner);
            }
            state.waiting.insert(index, piece);
            state.append_ready();
            drop(state);
            moved.notify_all();
        }
    });
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Progress<'_> {
    fn append_ready(&mut self) {
        while let Some(mut piece) = self.waiting.remove(&self.next) {
            self.next += 1;
            for (source, content) in self.out.sources.iter_mut().zip(&mut piece.contents) {
                source.content.append(content);
            }
            for (total, part) in self.out.topics.iter_mut().zip(&mut piece.topics) {
                total.add(&std::mem::take(part));
            }
            let remarks = &mut self.out.remarks;
            remarks.add(
                Code::UnknownChannel,
                std::mem::take(&mut piece.unknown),
                "messages of channels that the file does not define",
            );
            match std::mem::replace(&mut piece.loss, Loss::Nothing) {
                Loss::Nothing => {}
                Loss::Cut => remarks.add(
                    Code::PartialChunk,
                    1,
                    format!(
                        "the file ends within a chunk; {} whole messages before the cut were kept",
                        piece.messages
                    ),
                ),
                Loss::Dropped(reason) => {
                    remarks.add(Code::DamagedChunk, 1, format!("a chunk was dropped: {reason}"));
                }
            }
            piece.messages = 0;
            self.spare.push(piece);
        }
    }
}

impl TopicCount {
    fn add(&mut self, part: &Self) {
        if part.messages == 0 {
            return;
        }
        let first = self.messages == 0;
        self.first_log_ns = if first { part.first_log_ns } else { self.first_log_ns.min(part.first_log_ns) };
        self.last_log_ns = self.last_log_ns.max(part.last_log_ns);
        self.messages += part.messages;
        self.undecodable += part.undecodable;
        if self.first_error.is_none() {
            self.first_error.clone_from(&part.first_error);
        }
    }

    fn count(&mut self, log_ns: u64) {
        self.first_log_ns = if self.messages == 0 { log_ns } else { self.first_log_ns.min(log_ns) };
        self.last_log_ns = self.last_log_ns.max(log_ns);
        self.messages += 1;
    }
}

fn read_block(blocks: &mut Blocks, block: Block<'_>, routes: &BTreeMap<u16, Route>, piece: &mut Piece) {
    let (bytes, loss) = blocks.open(block);
    piece.loss = loss;
    let mut end = 0;
    let mut last: Option<(u16, &Route)> = None;
    for record in records(bytes) {
        end = record.end;
        if record.opcode != Opcode::MESSAGE {
            continue;
        }
        let Some(message) = MessageRecord::parse(record.body) else { continue };
        piece.messages += 1;
        let route = match last {
            Some((id, route)) if id == message.channel_id => Some(route),
            _ => routes.get(&message.channel_id),
        };
        let Some(route) = route else {
            piece.unknown += 1;
            continue;
        };
        last = Some((message.channel_id, route));
        let topic = &mut piece.topics[route.topic];
        topic.count(message.log_time_ns);
        if let Some((source, decoder)) = &route.read
            && let Err(error) = piece.contents[*source].read(decoder, &message)
        {
            topic.undecodable += 1;
            topic.first_error.get_or_insert(error);
        }
    }
    if end < bytes.len() && piece.loss == Loss::Nothing {
        piece.loss = Loss::Dropped(format!("its last {} bytes are no record", bytes.len() - end));
    }
}

/// Turns counts into remarks, and versioned values into tables.
fn finish(out: &mut Extracted) {
    for topic in &out.topics {
        if let Some(problem) = &topic.problem {
            out.remarks.add(
                Code::UnreadableSchema,
                topic.messages.max(1),
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
    for values in &halves {
        let stem = |source: &Source| {
            out.topics[source.topic].topic.rsplit_once('/').map(|(stem, _)| stem.to_owned())
        };
        for names in &halves {
            if let (Content::Versioned(v), Content::Versioned(n)) = (&values.content, &names.content)
                && stem(values) == stem(names)
                && let Some(table) = v.to_table(n)
            {
                sources.push(Source { topic: values.topic, content: Content::Table(table) });
            }
        }
    }
    out.sources = sources;
}
