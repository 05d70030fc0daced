//! What a recovery saved.

use super::{Part, tables::remark_parts};
use crate::log::Recovered;

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
