//! What the channels of a log say of their messages.

use std::collections::BTreeMap;

use crate::log::{channel::Definitions, decode::shape_at, files::ScannedLog, schema::Definition};

/// What a channel says of its messages.
#[derive(Debug, Default)]
pub(super) struct Described {
    pub(super) schema_encoding: String,
    /// `None` if it is not of CDR or not understood.
    pub(super) definition: Option<Definition>,
}

impl Described {
    /// Whether messages have a field, as far as it is known.
    pub(super) fn has(&self, path: &str) -> bool {
        self.definition.as_ref().is_some_and(|definition| shape_at(definition, path).is_some())
    }
}

/// Descriptions by topic and type; the first file that has one counts.
#[derive(Debug, Default)]
pub(in crate::log::read) struct Descriptions {
    by_name: BTreeMap<(String, String), Described>,
    none: Described,
}

impl Descriptions {
    pub(in crate::log::read) fn of(log: &ScannedLog<'_>) -> Self {
        let mut all = Self::default();
        for file in &log.files {
            let Definitions { schemas, channels } = Definitions::gather(&file.layout, file.source, false);
            for channel in channels.into_values() {
                let schema = schemas.get(&channel.schema_id);
                let name = schema.map_or("", |schema| schema.name.as_str());
                all.by_name.entry((channel.topic, name.to_owned())).or_insert_with(|| {
                    let Some(schema) = schema else { return Described::default() };
                    let described = matches!(channel.encoding.as_str(), "cdr" | "ros1");
                    let definition = Definition::parse(&schema.name, &schema.encoding, &schema.data);
                    Described {
                        schema_encoding: schema.encoding.clone(),
                        definition: definition.ok().filter(|_| described),
                    }
                });
            }
        }
        all
    }

    /// Topics and types.
    pub(super) fn names(&self) -> impl Iterator<Item = (&str, &str)> {
        self.by_name.keys().map(|(topic, type_name)| (topic.as_str(), type_name.as_str()))
    }

    pub(super) fn get(&self, topic: &str, type_name: &str) -> &Described {
        self.by_name.get(&(topic.to_owned(), type_name.to_owned())).unwrap_or(&self.none)
    }
}
