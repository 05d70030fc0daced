//! What was simulated.

use std::path::Path;

use super::{
    kit::{Document, Id, Section, Sentence, counted},
    next,
};
use crate::workflow::simulate::log::Run;

pub(crate) fn document(run: &Run, plant: &str, seed: u64, file: &Path) -> Document {
    let record = &run.outputs.record;
    let duration_s = record.t_s.last().copied().unwrap_or(0.0);
    let what = if run.prepared.commanded { "the command" } else { "the plan" };
    let ran = format!(
        "{duration_s:.2} s of {} running {what} on the plant {plant}, seed {seed}: {} in {}; the true parameters \
         of the machine are in its metadata.",
        counted(record.joints.len(), "joint"),
        counted(record.t_s.len(), "sample"),
        file.display(),
    );
    let section = Section::plain(Id::SUMMARY, [Sentence::finding(ran)]);
    Document::default().with(next::report(section, &[file]))
}
