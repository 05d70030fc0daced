//! What our joined logs say of their plan: the topic that it was sent on. One writer, one reader.

use std::collections::BTreeMap;

use super::{options::Selector, source::is_field, write::Topics};

/// Name of the metadata.
pub(super) const METADATA: &str = "hydrotrace.join";

const TOPIC: &str = "sent_topic";
const FIELD: &str = "sent_field";
/// Between topics, or fields, of which there are several.
const AND: &str = ", ";

/// What was sent on the way from a plan to its run, of a log that has the plan on our topic.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sent<'a> {
    topics: &'a str,
    fields: &'a str,
}

/// The entries for what was sent; topics and fields are joined by a comma.
pub(super) fn entries(topics: &str, fields: &str) -> BTreeMap<String, String> {
    let entry = |key: &str, text: &str| (key.to_owned(), text.to_owned());
    [entry(TOPIC, topics), entry(FIELD, fields)].into()
}

/// What was sent, if a log was joined and has its plan.
pub(super) fn sent<'a>(
    metadata: &'a BTreeMap<String, BTreeMap<String, String>>,
    mut topics: impl Iterator<Item = &'a str>,
) -> Option<Sent<'a>> {
    let entries = metadata.get(METADATA)?;
    let sent = Sent { topics: entries.get(TOPIC)?, fields: entries.get(FIELD)? };
    let plan = Topics::default().planned;
    (topics.any(|topic| topic == plan) && !sent.is_on(&plan)).then_some(sent)
}

impl Sent<'_> {
    /// Whether it was sent on this topic.
    pub(super) fn is_on(self, topic: &str) -> bool {
        self.topics.split(AND).any(|sent| sent == topic)
    }

    /// The plan behind what was sent, if that is what a selector names: the line that read the recorder's log reads the joined
    /// one. Other fields of the topic are themselves.
    pub(super) fn plan_behind(self, named: &Selector) -> Option<Selector> {
        let is_sent = |asked: &str| self.fields.split(AND).any(|field| is_field(field, asked));
        let same = self.is_on(&named.topic) && named.field.as_deref().is_none_or(is_sent);
        same.then(|| Selector { topic: Topics::default().planned, field: None })
    }
}
