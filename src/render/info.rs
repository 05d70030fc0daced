//! What is in a log.

use super::{
    kit::{Block, Document, Id, Section, Sentence, Table, fact},
    source::{clock, measured, planned, why, why_clock},
};
use crate::log::Survey;

pub(crate) fn document(survey: &Survey) -> Document {
    let files = survey.files.iter().map(|f| {
        let state = if f.closed { "closed properly" } else { "NOT CLOSED" };
        let bytes = match f.bytes {
            0..10_000 => format!("{} B", f.bytes),
            10_000..10_000_000 => format!("{:.1} kB", f.bytes as f64 / 1e3),
            _ => format!("{:.1} MB", f.bytes as f64 / 1e6),
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
            let stamps = why_clock(source).map(|why| format!("{} ({why})", source.time_base.name()));
            Block::Facts(vec![
                fact("planned", planned(source, ":")),
                fact("measured", measured(source, ":")),
                fact("why", why(source)),
                fact("clock", stamps.unwrap_or_else(|| clock(source))),
                fact("joints", survey.joints().collect::<Vec<_>>().join(", ")),
            ])
        }
        Err(why) if !survey.is_checked() => {
            let text = format!(
                "Not looked at, nor damage: {why}. The log spans {:.1} s by the recorder's clock.",
                survey.duration_s
            );
            Sentence::finding(text).into()
        }
        Err(error) => Sentence::finding(format!("nothing: {error}")).into(),
    }
}
