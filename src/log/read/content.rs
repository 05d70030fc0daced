//! Contents of the blocks of a recording, before plan and measurement are chosen.

use std::{borrow::Cow, collections::BTreeMap, io::Read, path::PathBuf};

use super::recording::{Attachment, FileInfo};
use crate::{
    log::{
        channel::Decoder,
        csv::scale_in,
        decode::LayoutCache,
        file::MessageRecord,
        joined::{self, Sent},
        source::{Form, Plans, Poses, Spec, Stamps, Table, Versioned},
    },
    remark::Remarks,
    series::JointKind,
};

/// Counts of a topic, whether it is read or not.
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
    /// Names of values, any of which can be chosen.
    pub(super) values: Vec<String>,
}

/// Samples or trajectories of one topic.
#[derive(Debug, Clone)]
pub(super) enum Content {
    Table(Box<Table>),
    Plans(Plans),
    Versioned(Versioned),
    Poses(Poses),
}

impl Content {
    pub(super) fn new(spec: &Spec, joints: &[String]) -> Self {
        match spec.form {
            Form::Plans => Self::Plans(Plans::default()),
            Form::Versioned | Form::VersionedNames => Self::Versioned(Versioned::default()),
            Form::Poses | Form::Transforms => {
                Self::Poses(Poses::new(&spec.fields, spec.form == Form::Transforms))
            }
            form => Self::Table(Box::new(Table::new(form, &spec.fields, joints, spec.alone.as_deref()))),
        }
    }

    pub(super) fn read(
        &mut self,
        decoder: &Decoder,
        caches: &mut BTreeMap<u16, LayoutCache>,
        message: &MessageRecord<'_>,
    ) -> Result<(), String> {
        let data = unpacked(decoder, message.data)?;
        let (channel, times_ns) = (message.channel_id, [message.publish_time_ns, message.log_time_ns]);
        let alike = match decoder {
            Decoder::Program(program) => program.little_endian(&data),
            Decoder::Tree(_) => None,
        };
        if let (Self::Table(table), Some(body)) = (&mut *self, alike)
            && table.take_alike(channel, body, times_ns)
        {
            return Ok(());
        }
        let cache = caches.entry(channel).or_default();
        macro_rules! read {
            ($sink:expr) => {{
                match decoder {
                    Decoder::Program(program) => {
                        program.run(&data, cache, $sink).map_err(|e| e.to_string())?
                    }
                    Decoder::Tree(tree) => tree.run(&data, $sink)?,
                }
                $sink.commit(times_ns[0], times_ns[1]);
            }};
        }
        match self {
            Self::Table(table) => {
                let table = &mut **table;
                read!(table);
                if let Some(body) = alike {
                    table.learn(channel, body, cache);
                }
            }
            Self::Plans(plans) => read!(plans),
            Self::Versioned(versioned) => read!(versioned),
            Self::Poses(poses) => read!(poses),
        }
        Ok(())
    }

    /// Rows that are to come, as the index of the log counts them: columns need not grow.
    pub(super) fn expect(&mut self, rows: usize) {
        if let Self::Table(table) = self {
            table.expected = rows;
        }
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
            (Self::Poses(mine), Self::Poses(theirs)) => mine.append(theirs),
            _ => {}
        }
    }
}

/// More than a message of joints has, bytes.
const MOST_UNPACKED: u64 = 1 << 26;

/// The bytes of a message. A recorder may pack each for itself; what starts as zstd does is no CDR.
fn unpacked<'a>(decoder: &Decoder, data: &'a [u8]) -> Result<Cow<'a, [u8]>, String> {
    const ZSTD: [u8; 4] = [0x28, 0xB5, 0x2F, 0xFD];
    if !(matches!(decoder, Decoder::Program(_)) && data.starts_with(&ZSTD)) {
        return Ok(Cow::Borrowed(data));
    }
    let mut bytes = Vec::new();
    let reader = zstd::stream::read::Decoder::with_buffer(data).map_err(|error| error.to_string())?;
    reader.take(MOST_UNPACKED).read_to_end(&mut bytes).map_err(|error| error.to_string())?;
    Ok(Cow::Owned(bytes))
}

/// One topic that holds joints, with its content.
#[derive(Debug, Clone)]
pub(super) struct Source {
    /// Index into the topics.
    pub(super) topic: usize,
    pub(super) content: Content,
    /// Files that it was read from, and how many rows came before each.
    pub(super) parts: Vec<(usize, usize)>,
}

/// Content of all files.
#[derive(Debug, Default)]
pub(super) struct Extracted {
    /// Of the first file.
    pub(super) path: PathBuf,
    pub(super) files: Vec<FileInfo>,
    /// Whether a recorder says that they belong together.
    pub(super) described: bool,
    pub(super) topics: Vec<TopicCount>,
    pub(super) sources: Vec<Source>,
    /// Index of the topic of a URDF, and its text: the first one of the topic with the shortest name.
    pub(super) description: Option<(usize, String)>,
    pub(super) attachments: Vec<Attachment>,
    pub(super) metadata: BTreeMap<String, BTreeMap<String, String>>,
    /// What each imported log among the files tells of its table.
    pub(super) tables: Vec<BTreeMap<String, String>>,
    pub(super) remarks: Remarks,
}

impl Extracted {
    /// What was sent, where a plan was put beside it.
    pub(super) fn sent(&self) -> Option<Sent<'_>> {
        joined::sent(&self.metadata, self.topics.iter().map(|t| t.topic.as_str()))
    }

    /// SI value of one unit of a joint, by the unit that ends the name of a field, or of the topic of one that has no name
    /// of its own; 1 where that says none.
    pub(super) fn scale(&self, source: usize, field: Option<usize>, kind: JointKind) -> f64 {
        let Content::Table(table) = &self.sources[source].content else { return 1.0 };
        let field = field.and_then(|at| table.fields.get(at)).map_or("", |field| &field.path);
        let lone = field.rsplit('.').next() == Some("data");
        scale_in(if lone { &self.topic_of(source).topic } else { field }, kind)
    }

    /// The stamps of a source that is a table.
    pub(super) fn stamps(&self, source: usize) -> Option<&Stamps> {
        match &self.sources[source].content {
            Content::Table(table) => Some(&table.stamps),
            _ => None,
        }
    }

    /// The topic of a source.
    pub(super) fn topic_of(&self, source: usize) -> &TopicCount {
        &self.topics[self.sources[source].topic]
    }
}

/// How one channel of one file is read.
pub(super) struct Route {
    pub(super) topic: usize,
    pub(super) read: Option<(usize, Decoder)>,
    /// Its messages may hold joints but cannot be read.
    pub(super) unreadable: bool,
    /// Its messages are URDFs.
    pub(super) describes: bool,
}

impl TopicCount {
    pub(super) fn add(&mut self, part: &Self) {
        if part.messages == 0 {
            return;
        }
        let first = self.messages == 0;
        self.first_log_ns = if first { part.first_log_ns } else { self.first_log_ns.min(part.first_log_ns) };
        self.last_log_ns = self.last_log_ns.max(part.last_log_ns);
        self.messages += part.messages;
        self.undecodable += part.undecodable;
        self.unread += part.unread;
        if self.first_error.is_none() {
            self.first_error.clone_from(&part.first_error);
        }
    }

    pub(super) fn count(&mut self, log_ns: u64) {
        self.first_log_ns = if self.messages == 0 { log_ns } else { self.first_log_ns.min(log_ns) };
        self.last_log_ns = self.last_log_ns.max(log_ns);
        self.messages += 1;
    }
}
