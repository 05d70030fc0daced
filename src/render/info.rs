//! What is in a log.

use super::{Part, Sheet, tables::remark_parts};
use crate::log::Survey;

/// As headings, sentences and tables.
pub fn info_parts(survey: &Survey) -> Vec<Part> {
    let mut parts = vec![Part::Heading("Files".into())];
    let files = survey.files.iter().map(|f| {
        let state = if f.closed { "closed properly" } else { "NOT CLOSED" };
        let bytes = if f.bytes < 10_000 {
            format!("{} B", f.bytes)
        } else {
            format!("{:.1} kB", f.bytes as f64 / 1e3)
        };
        vec![f.name.clone(), state.to_owned(), bytes, f.blocks.to_string()]
    });
    parts.push(Part::Sheet(Sheet {
        head: vec!["file", "state", "size", "blocks"],
        left: 2,
        rows: files.collect(),
    }));
    parts.push(Part::Heading("Topics".into()));
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
    let head = vec!["topic", "type", "joint fields", "messages", "Hz", "joints"];
    parts.push(Part::Sheet(Sheet { head, left: 3, rows: topics.collect() }));
    if !survey.attachments.is_empty() {
        parts.push(Part::Line(format!("Stored in the log: {}", survey.attachments.join(", "))));
    }
    parts.push(Part::Heading("A report would use".into()));
    match &survey.recording {
        Ok(recording) => {
            let source = &recording.source;
            let fact = |name: &str, value: String| (name.to_owned(), value);
            parts.push(Part::Facts(vec![
                fact("planned", format!("{}:{}", source.planned_topic, source.planned_field)),
                fact("measured", format!("{}:{}", source.measured_topic, source.measured_field)),
                fact("why", source.why.clone()),
                fact("clock", format!("{} ({})", source.time_base.name(), source.time_base_why)),
                fact("joints", survey.joints().collect::<Vec<_>>().join(", ")),
            ]));
        }
        Err(error) => parts.push(Part::Line(format!("nothing: {error}"))),
    }
    remark_parts(&survey.remarks, &mut parts);
    parts
}
