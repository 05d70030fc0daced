//! From the channels of a file to how each is read.

use std::{collections::BTreeMap, sync::Arc};

use super::{
    decode::{Program, Tree},
    file::{Block, Blocks, ChannelRecord, Layout, Loss, Opcode, SchemaRecord, Source, records},
    options::Selector,
    schema::Definition,
    source::{Role, Spec, spec_for},
};
use crate::threads::mapped;

/// How the messages of one channel are read.
#[derive(Debug, Clone)]
pub(super) enum Decoder {
    Program(Arc<Program>),
    Tree(Arc<Tree>),
}

/// One channel of one file.
#[derive(Debug)]
pub(super) struct Channel {
    pub(super) topic: String,
    pub(super) type_name: String,
    pub(super) encoding: String,
    /// How to read it, if it holds joints.
    pub(super) reader: Option<(Arc<Spec>, Decoder)>,
    /// Why it cannot be read, though its type may hold joints.
    pub(super) problem: Option<String>,
}

/// Channels and schemas of one file, by id; the first definition of an id holds.
pub(super) struct Definitions {
    pub(super) schemas: BTreeMap<u16, OwnedSchema>,
    pub(super) channels: BTreeMap<u16, ChannelRecord>,
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct OwnedSchema {
    pub(super) name: String,
    pub(super) encoding: String,
    pub(super) data: Vec<u8>,
}

impl Definitions {
    pub(super) fn of(schemas: &[SchemaRecord], channels: &[ChannelRecord]) -> Self {
        let mut all = Self { schemas: BTreeMap::new(), channels: BTreeMap::new() };
        for schema in schemas {
            all.add_schema(schema);
        }
        for channel in channels {
            all.add_channel(channel.clone());
        }
        all
    }

    /// Gathers definitions outside chunks, and those inside if the former may be incomplete or
    /// the caller says so.
    pub(super) fn gather(layout: &Layout, source: &Source, look_inside: bool) -> Self {
        let mut all = Self::of(&layout.schemas, &layout.channels);
        if !look_inside
            && layout.channels_complete
            && all.channels.values().all(|c| c.schema_id == 0 || all.schemas.contains_key(&c.schema_id))
        {
            return all;
        }
        let inside =
            mapped(&layout.blocks, Blocks::new, |blocks, block| Self::inside(blocks, *block, source));
        // A recorder may define a channel in its first chunk alone: what a chunk that is not whole says holds where no
        // other says it.
        let (whole, doubtful): (Vec<_>, Vec<_>) = inside.into_iter().partition(|(is_whole, _)| *is_whole);
        for (_, one) in whole.into_iter().chain(doubtful) {
            one.schemas.into_iter().for_each(|(id, schema)| {
                all.schemas.entry(id).or_insert(schema);
            });
            one.channels.into_values().for_each(|channel| all.add_channel(channel));
        }
        all
    }

    /// Whether a block is as it was written, and what it defines.
    fn inside(blocks: &mut Blocks, block: Block, source: &Source) -> (bool, Self) {
        let mut found = Self { schemas: BTreeMap::new(), channels: BTreeMap::new() };
        let (bytes, loss) = blocks.open_doubtful(block, source);
        for record in records(bytes) {
            match record.opcode {
                Opcode::SCHEMA => {
                    if let Some(schema) = SchemaRecord::parse(record.body) {
                        found.add_schema(&schema);
                    }
                }
                Opcode::CHANNEL => {
                    if let Some(channel) = ChannelRecord::parse(record.body) {
                        found.add_channel(channel);
                    }
                }
                _ => {}
            }
        }
        (matches!(loss, Loss::Nothing | Loss::Cut), found)
    }

    fn add_schema(&mut self, schema: &SchemaRecord) {
        self.schemas.entry(schema.id).or_insert_with(|| OwnedSchema {
            name: schema.name.clone(),
            encoding: schema.encoding.clone(),
            data: schema.data.clone(),
        });
    }

    fn add_channel(&mut self, channel: ChannelRecord) {
        self.channels.entry(channel.id).or_insert(channel);
    }

    /// Decides for every channel whether and how it is read; `speeds` says of a topic whose type does not tell plan
    /// from measurement whether its speeds are, `alone` names the joint of a topic with one number a message.
    pub(super) fn plan(
        self,
        selectors: &[(Role, Selector)],
        speeds: &impl Fn(&str) -> bool,
        alone: &impl Fn(&str) -> Option<String>,
    ) -> BTreeMap<u16, Channel> {
        let empty = OwnedSchema { name: String::new(), encoding: String::new(), data: Vec::new() };
        // Channels of one schema share their reader: files may have many of both.
        let mut readers: BTreeMap<(u16, String, Option<String>, bool), Reader> = BTreeMap::new();
        let mut steps_left = MAX_STEPS;
        let Self { schemas, channels } = self;
        let plan = channels.into_iter().map(|(id, record)| {
            let schema = schemas.get(&record.schema_id).unwrap_or(&empty);
            let mine = selectors.iter().filter(|(_, s)| s.topic == record.topic);
            let mine: Vec<_> = mine.map(|(role, s)| (*role, s)).collect();
            let topic = (!mine.is_empty()).then(|| record.topic.clone());
            let speeds = speeds(&record.topic) || mine.iter().any(|(role, _)| *role != Role::Measured);
            let key = (record.schema_id, record.encoding.clone(), topic, speeds);
            let read = || {
                let (mut reader, problem) =
                    reader(schema, &record.encoding, (&mine, speeds), &mut steps_left);
                if let Some((spec, _)) = reader.as_mut().filter(|_| !mine.is_empty()) {
                    Arc::make_mut(spec).alone = alone(&record.topic);
                }
                (reader, problem)
            };
            let (reader, problem) = readers.entry(key).or_insert_with(read).clone();
            let type_name = schema.name.clone();
            let channel =
                Channel { topic: record.topic, type_name, encoding: record.encoding, reader, problem };
            (id, channel)
        });
        plan.collect()
    }
}

/// All programs of a file together; one of the joints of an arm takes some hundred steps.
const MAX_STEPS: usize = 1_000_000;

/// How to read a channel, or why it cannot be read though it may hold joints.
type Reader = (Option<(Arc<Spec>, Decoder)>, Option<String>);

/// The fields that the caller named, and whether speeds are wanted.
type Wanted<'a> = (&'a [(Role, &'a Selector)], bool);

/// What is said of messages of an encoding that is not read; `None` of one that is.
pub(super) fn unread(encoding: &str) -> Option<String> {
    let read = matches!(encoding, "cdr" | "ros1" | "json" | "protobuf");
    (!read).then(|| {
        format!(
            "its messages are encoded as {encoding:?}, which is not read; cdr, ros1, json and protobuf are"
        )
    })
}

fn reader(schema: &OwnedSchema, encoding: &str, selectors: Wanted<'_>, steps_left: &mut usize) -> Reader {
    match encoding {
        "cdr" | "ros1" => cdr(schema, selectors, steps_left),
        "json" => tree(schema, selectors, |spec| Ok(Tree::json(&spec.wants))),
        "protobuf" => tree(schema, selectors, |spec| Tree::protobuf(&schema.name, &schema.data, &spec.wants)),
        other => {
            let matters = spec_for(&schema.name, None, selectors).is_some();
            (None, unread(other).filter(|_| matters))
        }
    }
}

fn cdr(schema: &OwnedSchema, selectors: Wanted<'_>, steps_left: &mut usize) -> Reader {
    let definition = match Definition::parse(&schema.name, &schema.encoding, &schema.data) {
        Ok(definition) => definition,
        Err(problem) => {
            // What is not understood matters only where joints may be lost.
            let matters = spec_for(&schema.name, None, selectors).is_some();
            return (None, matters.then(|| problem.to_string()));
        }
    };
    let Some(spec) = spec_for(&schema.name, Some(&definition), selectors) else { return (None, None) };
    match Program::compile(&definition, &spec.wants, *steps_left) {
        Ok(program) => {
            *steps_left -= program.cost.min(*steps_left);
            (Some((Arc::new(spec), Decoder::Program(Arc::new(program)))), None)
        }
        Err(error) => (None, Some(error.to_string())),
    }
}

fn tree(schema: &OwnedSchema, selectors: Wanted<'_>, tree: impl Fn(&Spec) -> Result<Tree, String>) -> Reader {
    match spec_for(&schema.name, None, selectors) {
        None => (None, None),
        Some(spec) => match tree(&spec) {
            Ok(tree) => (Some((Arc::new(spec), Decoder::Tree(Arc::new(tree)))), None),
            Err(problem) => (None, Some(problem)),
        },
    }
}
