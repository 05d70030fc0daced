//! What is in a log.

use serde::Serialize;

use super::kit::{Block, Document, Id, Section, Sentence, Table, fact};
use crate::{
    document,
    log::{FileInfo, SourceInfo, Survey, TopicInfo},
    remark::Remark,
};

#[derive(Serialize)]
struct Json<'a> {
    format: &'static str,
    program: &'static str,
    files: &'a [FileInfo],
    topics: &'a [TopicInfo],
    attachments: &'a [String],
    source: Option<&'a SourceInfo>,
    no_report_because: Option<String>,
    joints: Vec<&'a str>,
    remarks: &'a [Remark],
}

/// As JSON.
pub fn json(survey: &Survey) -> String {
    document::pretty(&Json {
        format: "hydrotrace.info.v1",
        program: document::PROGRAM,
        files: &survey.files,
        topics: &survey.topics,
        attachments: &survey.attachments,
        source: survey.recording.as_ref().ok().map(|r| &r.source),
        no_report_because: survey.recording.as_ref().err().map(ToString::to_string),
        joints: joints(survey),
        remarks: survey.remarks.as_slice(),
    })
}

/// The joints that a report would cover.
fn joints(survey: &Survey) -> Vec<&str> {
    let Ok(recording) = &survey.recording else { return Vec::new() };
    let planned = recording.planned.tracks.iter().map(crate::series::Track::name);
    planned.filter(|name| recording.measured.track(name).is_some()).collect()
}

/// As headings, sentences and tables.
pub fn document(survey: &Survey) -> Document {
    let files = survey.files.iter().map(|f| {
        let state = if f.closed { "closed properly" } else { "NOT CLOSED" };
        let bytes = if f.bytes < 10_000 {
            format!("{} B", f.bytes)
        } else {
            format!("{:.1} kB", f.bytes as f64 / 1e3)
        };
        vec![f.name.clone(), state.to_owned(), bytes, f.blocks.to_string()]
    });
    let topics = survey.topics.iter().map(|t| {
        let joints = if t.joints.is_empty() { String::new() } else { t.joints.len().to_string() };
        let encoding = if t.encoding == "cdr" { String::new() } else { format!(" ({})", t.encoding) };
        vec![
            t.topic.clone(),
            format!("{}{encoding}", t.type_name),
            t.joint_fields.join(" "),
            t.messages.to_string(),
            if t.rate_hz > 0.0 { format!("{:.1}", t.rate_hz) } else { String::new() },
            joints,
        ]
    });
    let files = Table::new(&["file", "state"], &["size", "blocks"], files);
    let topics = Table::new(&["topic", "type", "joint fields"], &["messages", "Hz", "joints"], topics);
    let stored = &survey.attachments;
    let stored =
        (!stored.is_empty()).then(|| Sentence::finding(format!("Stored in the log: {}", stored.join(", "))));
    Document::default()
        .with(Section::new(Id::OTHER, "Files", [files]))
        .with(Section::new(Id::OTHER, "Topics", [topics]).with_all(stored))
        .with(Section::new(Id::SUMMARY, "A report would use", [used(survey)]))
        .remarked(&survey.remarks)
}

fn used(survey: &Survey) -> Block {
    match &survey.recording {
        Ok(recording) => {
            let source = &recording.source;
            Block::Facts(vec![
                fact("planned", format!("{}:{}", source.planned_topic, source.planned_field)),
                fact("measured", format!("{}:{}", source.measured_topic, source.measured_field)),
                fact("why", &source.why),
                fact("clock", format!("{} ({})", source.time_base.name(), source.time_base_why)),
                fact("joints", joints(survey).join(", ")),
            ])
        }
        Err(error) => Sentence::finding(format!("nothing: {error}")).into(),
    }
}
