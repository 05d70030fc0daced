//! What a recovery saved.

use serde::Serialize;

use super::kit::{Document, Id, Section, Sentence};
use crate::{document, log::Recovered, remark::Remark};

#[derive(Serialize)]
struct Json<'a> {
    format: &'static str,
    program: &'static str,
    messages: u64,
    blocks: usize,
    dropped_blocks: u64,
    attachments: usize,
    remarks: &'a [Remark],
}

/// As JSON.
pub fn json(recovered: &Recovered) -> String {
    document::pretty(&Json {
        format: "hydrotrace.recover.v1",
        program: document::PROGRAM,
        messages: recovered.messages,
        blocks: recovered.blocks,
        dropped_blocks: recovered.dropped_blocks,
        attachments: recovered.attachments,
        remarks: recovered.remarks.as_slice(),
    })
}

/// As sentences.
pub fn document(output: &str, recovered: &Recovered) -> Document {
    let Recovered { messages, blocks, dropped_blocks, attachments, remarks } = recovered;
    let saved = format!(
        "{messages} messages and {attachments} attachments saved to {output}, from {blocks} chunks; {dropped_blocks} \
         chunks were damaged and are lost."
    );
    let whole = remarks.is_empty().then(|| Sentence::finding("Nothing was lost: the log was whole."));
    let section = Section::plain(Id::SUMMARY, [Sentence::finding(saved)]).with_all(whole);
    Document::default().with(section).remarked(remarks)
}
