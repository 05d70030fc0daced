//! From the channels of a file to how each is read.

use std::collections::BTreeMap;

use rayon::prelude::*;

use super::{
    decode::{Program, Tree},
    file::{Block, Blocks, ChannelRecord, Layout, Opcode, SchemaRecord, records},
    schema::Definition,
    source::{Role, Selector, Spec, spec_for},
};

/// How the messages of one channel are read.
#[derive(Debug, Clone)]
pub(super) enum Decoder {
    Program(Program),
    Tree(Tree),
}

/// One channel of one file.
#[derive(Debug)]
pub(super) struct Channel {
    pub(super) topic: String,
    pub(super) type_name: String,
    pub(super) encoding: String,
    /// How to read it, if it holds joints.
    pub(super) reader: Option<(Spec, Decoder)>,
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
    /// Gathers definitions outside chunks, and those inside if the former may be incomplete.
    pub(super) fn gather(layout: &Layout<'_>) -> Self {
        let mut all = Self { schemas: BTreeMap::new(), channels: BTreeMap::new() };
        layout.schemas.iter().for_each(|schema| all.add_schema(schema));
        layout.channels.iter().for_each(|channel| all.add_channel(channel.clone()));
        if layout.channels_complete
            && all.channels.values().all(|c| c.schema_id == 0 || all.schemas.contains_key(&c.schema_id))
        {
            return all;
        }
        let inside: Vec<Self> = layout
            .blocks
            .par_iter()
            .map_init(Blocks::new, |blocks, block| Self::inside(blocks, *block))
            .collect();
        for one in inside {
            one.schemas.into_iter().for_each(|(id, schema)| {
                all.schemas.entry(id).or_insert(schema);
            });
            one.channels.into_values().for_each(|channel| all.add_channel(channel));
        }
        all
    }

    fn inside(blocks: &mut Blocks, block: Block<'_>) -> Self {
        let mut found = Self { schemas: BTreeMap::new(), channels: BTreeMap::new() };
        for record in records(blocks.open(block).0) {
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
        found
    }

    fn add_schema(&mut self, schema: &SchemaRecord<'_>) {
        self.schemas.entry(schema.id).or_insert_with(|| OwnedSchema {
            name: schema.name.clone(),
            encoding: schema.encoding.clone(),
            data: schema.data.to_vec(),
        });
    }

    fn add_channel(&mut self, channel: ChannelRecord) {
        self.channels.entry(channel.id).or_insert(channel);
    }

    /// Decides for every channel whether and how it is read.
    pub(super) fn plan(&self, selectors: &[(Role, Selector)]) -> BTreeMap<u16, Channel> {
        let mut definitions: BTreeMap<u16, Result<Definition, String>> = BTreeMap::new();
        let empty = OwnedSchema { name: String::new(), encoding: String::new(), data: Vec::new() };
        self.channels
            .iter()
            .map(|(&id, record)| {
                let schema = self.schemas.get(&record.schema_id).unwrap_or(&empty);
                let mine: Vec<_> = selectors
                    .iter()
                    .filter(|(_, s)| s.topic == record.topic)
                    .map(|(role, s)| (*role, s))
                    .collect();
                let (reader, problem) = match record.encoding.as_str() {
                    "cdr" => {
                        let definition = definitions.entry(record.schema_id).or_insert_with(|| {
                            Definition::parse(&schema.name, &schema.encoding, &schema.data)
                                .map_err(|e| e.to_string())
                        });
                        cdr(schema, definition, &mine)
                    }
                    "json" => {
                        let tree = |spec: &Spec| Ok(Tree::json(&spec.wants));
                        tree_reader(&schema.name, &mine, tree)
                    }
                    "protobuf" => {
                        let tree = |spec: &Spec| Tree::protobuf(&schema.name, &schema.data, &spec.wants);
                        tree_reader(&schema.name, &mine, tree)
                    }
                    other => {
                        let problem = spec_for(&schema.name, None, &mine)
                            .map(|_| format!("its messages are encoded as {other:?}, which is not read"));
                        (None, problem)
                    }
                };
                let channel = Channel {
                    topic: record.topic.clone(),
                    type_name: schema.name.clone(),
                    encoding: record.encoding.clone(),
                    reader,
                    problem,
                };
                (id, channel)
            })
            .collect()
    }
}

type Reader = (Option<(Spec, Decoder)>, Option<String>);

fn cdr(
    schema: &OwnedSchema,
    definition: &Result<Definition, String>,
    selectors: &[(Role, &Selector)],
) -> Reader {
    match definition {
        Err(problem) => {
            // A type that a recorder left undescribed matters only where joints may be lost.
            let matters = !schema.data.is_empty() || spec_for(&schema.name, None, selectors).is_some();
            (None, matters.then(|| problem.clone()))
        }
        Ok(definition) => match spec_for(&schema.name, Some(definition), selectors) {
            None => (None, None),
            Some(spec) => match Program::compile(definition, &spec.wants) {
                Ok(program) => (Some((spec, Decoder::Program(program))), None),
                Err(error) => (None, Some(error.to_string())),
            },
        },
    }
}

fn tree_reader(
    name: &str,
    selectors: &[(Role, &Selector)],
    tree: impl Fn(&Spec) -> Result<Tree, String>,
) -> Reader {
    match spec_for(name, None, selectors) {
        None => (None, None),
        Some(spec) => match tree(&spec) {
            Ok(tree) => (Some((spec, Decoder::Tree(tree))), None),
            Err(problem) => (None, Some(problem)),
        },
    }
}
