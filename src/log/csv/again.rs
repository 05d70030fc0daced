//! A header in mid-table: the same again says nothing, another one gives the columns another meaning.

use ::csv::ByteRecord;

use super::{
    head::{Head, are_names},
    rows::cell_text,
};

/// Whether a row below the header is another header: names alone, one of them known, and not the same ones.
pub(super) fn is_another_header(head: &Head, record: &ByteRecord) -> bool {
    // Nearly all rows begin with a number.
    let begins = record.as_slice().trim_ascii_start().first();
    if !head.named || begins.is_none_or(|byte| byte.is_ascii_digit() || b"+-.,".contains(byte)) {
        return false;
    }
    let cells: Vec<String> = record.iter().map(cell_text).collect();
    are_names(&cells)
        && cells.iter().any(|cell| !cell.is_empty() && head.written.contains(cell))
        && trimmed(&cells) != trimmed(&head.written)
}

/// Without the empty cells that separators at the end make.
fn trimmed(cells: &[String]) -> &[String] {
    let last = cells.iter().rposition(|cell| !cell.is_empty());
    &cells[..last.map_or(0, |last| last + 1)]
}
