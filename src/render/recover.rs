//! What a recovery saved.

use serde::Serialize;

use super::{Part, json, tables::remark_parts};
use crate::{log::Recovered, remark::Remark};

#[derive(Serialize)]
struct Document<'a> {
    format: &'static str,
    program: &'static str,
    messages: u64,
    blocks: usize,
    dropped_blocks: u64,
    attachments: usize,
    remarks: &'a [Remark],
}

/// As JSON.
pub fn recovered_json(recovered: &Recovered) -> String {
    json::pretty(&Document {
        format: "hydrotrace.recover.v1",
        program: json::PROGRAM,
        messages: recovered.messages,
        blocks: recovered.blocks,
        dropped_blocks: recovered.dropped_blocks,
        attachments: recovered.attachments,
        remarks: recovered.remarks.as_slice(),
    })
}

/// As sentences.
pub fn recovered_parts(output: &str, recovered: &Recovered) -> Vec<Part> {
    let Recovered { messages, blocks, dropped_blocks, attachments, remarks } = recovered;
    let mut parts = vec![Part::Line(format!(
        "{messages} messages and {attachments} attachments saved to {output}, from {blocks} chunks of which \
         {dropped_blocks} had to be dropped."
    ))];
    if remarks.is_empty() {
        parts.push(Part::Line("Nothing was lost: the log was whole.".into()));
    }
    remark_parts(remarks, &mut parts);
    parts
}
