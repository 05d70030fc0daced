//! What a recording doubts of what came.

use std::path::PathBuf;

use super::{
    Recording,
    parts::{part_name, part_pattern},
};
use crate::{
    log::{CsvError, JsonLines},
    remark::{Code, Remarks},
};

/// Lines that became no rows.
#[derive(Debug, Default)]
pub(super) struct LeftOut {
    /// No objects, where objects come.
    pub(super) unread: u64,
    /// Of words before the first object with numbers.
    pub(super) words: u64,
    /// Of words among rows.
    pub(super) asides: u64,
    /// Longer than any row.
    pub(super) too_long: u64,
    /// Before another header, their own columns unknown.
    pub(super) untold: u64,
    /// Of a header whose columns cannot be told, and why those of the first such cannot.
    pub(super) below: u64,
    pub(super) why: Option<String>,
    /// Of numbers before the first header, and what was wrong with them.
    pub(super) headless: u64,
    pub(super) no_header: Option<CsvError>,
    /// Parts that began where a joint's keys came.
    pub(super) later: u64,
}

impl Recording<'_> {
    /// Doubts about all that came.
    pub(super) fn remarks(&self) -> Remarks {
        let mut remarks = Remarks::default();
        for (number, stream) in (1..).zip(&self.closed) {
            let mut of_stream = stream.remarks();
            // The other side came later.
            of_stream.retain(|remark| number == self.closed.len() || remark.code != Code::OneSide);
            remarks.extend(of_stream);
        }
        let LeftOut { unread, words, asides, too_long, untold, below, why, headless, later, .. } =
            &self.left_out;
        let message =
            "keys of a joint that came after the columns were settled: what follows is in a part of its own";
        remarks.add(Code::NotSupported, *later, message);
        let message = "lines of numbers before the first header, whose columns cannot be told; left out";
        remarks.add(Code::UndecodableMessage, *headless, message);
        remarks.add(Code::UndecodableMessage, *asides, "lines of words among the rows; left out");
        let message = "lines of words before the first with numbers; left out";
        remarks.add(Code::UndecodableMessage, *words, message);
        let message = "lines before a header with other columns, whose own columns cannot be told; left out";
        remarks.add(Code::UndecodableMessage, *untold, message);
        if let Some(why) = why {
            let message =
                format!("lines of a header whose columns cannot be told, left out until the next one: {why}");
            remarks.add(Code::UndecodableMessage, *below, message);
        }
        remarks.add(Code::UndecodableMessage, *unread, "lines that are no JSON object; left out");
        if let Some((keys, lines)) = self.objects.as_ref().and_then(JsonLines::late) {
            let message = format!(
                "lines with keys that came after the columns were settled, and were left out: {keys}; name them before, as \
                 --measured JOINT=KEY, or begin when they are sent"
            );
            remarks.add(Code::NotSupported, lines, message);
        }
        remarks.add(Code::UndecodableMessage, *too_long, "lines longer than any row; left out");
        if let Some(first) = self.taken.first() {
            let message = format!(
                "names of parts that were taken, from {} on, and were stepped over; a pattern such as {} reads both as one run",
                first.display(),
                part_pattern(&self.inputs.output)
            );
            remarks.add(Code::OtherFile, self.taken.len() as u64, message);
        }
        let old = (self.number + 1..).map(|number| part_name(&self.inputs.output, number));
        let old: Vec<PathBuf> = old.take_while(|path| self.inputs.replace && path.exists()).collect();
        if let Some(first) = old.first() {
            let message = format!(
                "parts of an earlier recording that are still beside this one, from {} on; remove them, or a pattern such as \
                 {} reads both as one run",
                first.display(),
                part_pattern(&self.inputs.output)
            );
            remarks.add(Code::OtherFile, old.len() as u64, message);
        }
        remarks
    }
}
