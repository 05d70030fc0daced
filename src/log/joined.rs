//! What our joined logs say of their plan, the topic that it was sent on, and of the units of what was recorded. One writer, one
//! reader.

use std::collections::{BTreeMap, BTreeSet};

use super::{csv::LengthUnit, options::Selector, source::is_field, write::Topics};

/// Name of the metadata.
pub(super) const METADATA: &str = "hydrotrace.join";

const TOPIC: &str = "sent_topic";
const FIELD: &str = "sent_field";
const WRITTEN: &str = "written_topics";
const DEGREES: &str = "topics_in_degrees";
const LENGTHS: &str = "lengths";
/// Between topics, or fields, of which there are several.
const AND: &str = ", ";

/// What was sent on the way from a plan to its run, of a log that has the plan on our topic.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sent<'a> {
    topics: &'a str,
    fields: &'a str,
}

/// In what the topics of a joined log are: its messages are those of the recorder, and the plan beside them is in rad and m.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct RecordedIn {
    /// Topics in degrees.
    pub degrees: BTreeSet<String>,
    /// Units of joints that slide, on every topic that was recorded.
    pub lengths: BTreeMap<String, LengthUnit>,
}

impl RecordedIn {
    /// With topics, joined by a comma, in degrees.
    pub fn with_degrees(mut self, topics: &str) -> Self {
        self.degrees.extend(topics.split(AND).filter(|topic| !topic.is_empty()).map(str::to_owned));
        self
    }
}

/// The entries for what was sent, whose topics and fields are joined by a comma, for the topics that were written, and for the units of
/// the others.
pub(super) fn entries(
    sent: Option<[&str; 2]>,
    written: &[&str],
    recorded: &RecordedIn,
) -> BTreeMap<String, String> {
    let lengths: Vec<String> =
        recorded.lengths.iter().map(|(joint, unit)| format!("{joint}={}", unit.name())).collect();
    let degrees: Vec<&str> = recorded.degrees.iter().map(String::as_str).collect();
    let [topics, fields] = sent.unwrap_or_default();
    let all = [
        (TOPIC, topics.to_owned()),
        (FIELD, fields.to_owned()),
        (WRITTEN, written.join(AND)),
        (DEGREES, degrees.join(AND)),
        (LENGTHS, lengths.join(AND)),
    ];
    all.into_iter().filter(|(_, text)| !text.is_empty()).map(|(key, text)| (key.to_owned(), text)).collect()
}

/// The topics that a join wrote, in rad and m whatever is said of the others, and the units of those.
pub(super) fn units(metadata: &BTreeMap<String, BTreeMap<String, String>>) -> (BTreeSet<String>, RecordedIn) {
    let all = |key: &str| {
        let text = metadata.get(METADATA).and_then(|entries| entries.get(key));
        text.into_iter().flat_map(|text| text.split(AND)).map(str::to_owned)
    };
    let lengths = all(LENGTHS).filter_map(|text| LengthUnit::of_joint(&text)).collect();
    (all(WRITTEN).collect(), RecordedIn { degrees: all(DEGREES).collect(), lengths })
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
