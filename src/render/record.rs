//! The words of `record`.

use std::path::Path;

use super::{
    kit::{Block, Document, Id, Section, Sentence, counted, fact},
    next,
};
use crate::{
    remark::Code,
    workflow::record::{Progress, Recorded},
};

/// How far a recording is, in a line.
pub(crate) fn progress(now: &Progress) -> String {
    let Progress { rows, lines, bytes, joints } = *now;
    match joints {
        0 => format!(
            "waiting for rows: {} so far",
            counted(usize::try_from(lines).unwrap_or(usize::MAX), "line")
        ),
        joints => format!("{rows} rows of {}, {:.1} MB", counted(joints, "joint"), bytes as f64 / 1e6),
    }
}

/// As sentences; `joined` is the log with the plan beside the run.
pub(crate) fn document(recorded: &Recorded, joined: Option<&Path>) -> Document {
    let Recorded { logs, lines, rows, joints, columns, remarks, .. } = recorded;
    let names: Vec<String> = logs.iter().map(|log| log.display().to_string()).collect();
    let written = format!(
        "{rows} rows of {lines} lines written to {}: {}.",
        names.join(", "),
        counted(joints.len(), "joint")
    );
    let columns: Vec<_> = columns.iter().map(|column| fact("column", column.clone())).collect();
    let section = Section::plain(Id::SUMMARY, [Sentence::finding(written)]).with(Block::Facts(columns));
    let with_plan =
        joined.map(|log| Sentence::finding(format!("With the plan beside it: {}.", log.display())));
    let runs = joined.map_or_else(|| logs.clone(), |log| vec![log.to_owned()]);
    let section = section.with_all(with_plan);
    let one_side = remarks.as_slice().iter().any(|remark| remark.code == Code::OneSide);
    let next = if one_side && joined.is_none() {
        next::plan_missing(section, &runs)
    } else {
        next::report(section, &runs)
    };
    Document::default().with(next).remarked(remarks)
}
