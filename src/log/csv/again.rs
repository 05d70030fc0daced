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

/// Where another header begins in the first lines of a table, bytes: names alone below a row of numbers, one of them
/// known from above, and not the same ones.
pub fn other_header(lines: &[u8]) -> Option<usize> {
    let mut heads: Vec<Vec<String>> = Vec::new();
    let (mut at, mut has_rows) = (0, false);
    for line in lines.split_inclusive(|byte| *byte == b'\n') {
        let cells = cells(line);
        if are_names(&cells) {
            let known = |head: &Vec<String>| cells.iter().any(|cell| !cell.is_empty() && head.contains(cell));
            let same = |head: &Vec<String>| trimmed(head) == trimmed(&cells);
            if !has_rows {
                heads.push(cells);
            } else if heads.iter().any(known) && !heads.iter().any(same) {
                return Some(at);
            }
        } else {
            has_rows |= line.trim_ascii_start().first().is_some_and(u8::is_ascii_digit);
        }
        at += line.len();
    }
    None
}

/// The cells of a line by the separator that makes the most of them.
fn cells(line: &[u8]) -> Vec<String> {
    let line = line.trim_ascii_end();
    let pieces = |separator: u8| memchr::memchr_iter(separator, line).count();
    let separator = [b';', b'\t', b',', b'|', b' '].into_iter().rev().max_by_key(|one| pieces(*one));
    line.split(|byte| Some(*byte) == separator).map(cell_text).collect()
}
