//! What is in closed files, by their summaries alone.

use std::collections::BTreeMap;

use super::recording::{FileInfo, Survey, TopicInfo};
use crate::{
    log::{
        channel::Definitions,
        error::LogError,
        file::{Source, Summary, summary},
        files::{LogFiles, file_name},
        source::{Form, Spec},
    },
    text::shell_argument,
    units::NS_PER_S,
};

impl LogFiles {
    /// Bytes of all files together.
    pub fn bytes(&self) -> u64 {
        self.sources().map(|(_, source)| source.length()).sum()
    }

    /// Lists what is in the files by the summaries at their ends, without a look at the messages; `None` if one of them
    /// has none that can be relied on.
    pub fn survey_by_index(&self) -> Option<Survey> {
        let read = |(path, source)| Some((file_name(path), Source::length(source), summary(source)?));
        let summaries = self.sources().map(read).collect::<Option<Vec<_>>>()?;
        let mut topics = BTreeMap::new();
        let (mut files, mut attachments) = (Vec::new(), Vec::new());
        for (name, bytes, summary) in summaries {
            files.push(FileInfo { name, bytes, blocks: summary.chunks, closed: true });
            attachments.extend(summary.attachments.iter().cloned());
            add_topics(summary, &mut topics);
        }
        let logs = self.sources().map(|(path, _)| shell_argument(path)).collect::<Vec<_>>().join(" ");
        let ends = topics.values().filter(|topic: &&Counted| topic.log_ns[0] <= topic.log_ns[1]);
        let begins_ns = ends.clone().map(|topic| topic.log_ns[0]).min().unwrap_or(0);
        let ends_ns = ends.map(|topic| topic.log_ns[1]).max().unwrap_or(0);
        Some(Survey {
            files,
            topics: topics.into_values().map(Counted::info).collect(),
            attachments,
            duration_s: ends_ns.saturating_sub(begins_ns) as f64 / NS_PER_S,
            recording: Err(LogError::NotLookedAt { logs }),
            remarks: self.remarks().clone(),
        })
    }
}

/// A topic, and when its first and its last message were received, where that is known.
struct Counted {
    info: TopicInfo,
    log_ns: [u64; 2],
    timed: bool,
}

impl Counted {
    fn info(self) -> TopicInfo {
        let Self { mut info, log_ns: [first_ns, last_ns], timed } = self;
        let spread_s = last_ns.saturating_sub(first_ns) as f64 / NS_PER_S;
        if timed && info.messages > 1 && spread_s > 0.0 {
            info.rate_hz = (info.messages - 1) as f64 / spread_s;
        }
        info
    }
}

fn add_topics(summary: Summary, topics: &mut BTreeMap<(String, String), Counted>) {
    let Summary { schemas, channels, messages, log_ns, log_ns_by_channel, .. } = summary;
    let definitions = Definitions::of(&schemas, &channels);
    for (id, channel) in definitions.plan(&[], &|_| false, &|_| None) {
        let key = (channel.topic.clone(), channel.type_name.clone());
        let fields = channel.reader.map(|(spec, _)| fields(&spec)).unwrap_or_default();
        let topic = topics.entry(key).or_insert_with(|| Counted {
            info: TopicInfo {
                topic: channel.topic,
                type_name: channel.type_name,
                encoding: channel.encoding,
                messages: 0,
                rate_hz: 0.0,
                joint_fields: fields,
                joints: Vec::new(),
            },
            log_ns: [u64::MAX, 0],
            timed: true,
        });
        let own = messages.get(&id).copied().unwrap_or(0);
        let times_ns = log_ns_by_channel.get(&id);
        topic.info.messages += own;
        topic.timed &= own == 0 || times_ns.is_some();
        if own > 0 {
            let [first_ns, last_ns] = *times_ns.unwrap_or(&log_ns);
            topic.log_ns = [topic.log_ns[0].min(first_ns), topic.log_ns[1].max(last_ns)];
        }
    }
}

/// Fields of a type that may hold positions of joints.
fn fields(spec: &Spec) -> Vec<String> {
    match spec.form {
        Form::Plans => vec!["points.positions".to_owned()],
        _ => spec.fields.iter().filter(|field| !field.is_velocity).map(|field| field.path.clone()).collect(),
    }
}
