//! A header in mid-table: the same again says nothing, another one gives the columns another meaning.

use ::csv::ByteRecord;

use super::{
    head::{Head, are_names},
    label::label,
    rows::cell_text,
};

/// Whether a row below the header is another header: names alone, one of them known or a time, and not the same ones.
pub(super) fn is_another_header(head: &Head, record: &ByteRecord) -> bool {
    // Nearly all rows begin with a number.
    let begins = record.as_slice().trim_ascii_start().first();
    if !head.named || begins.is_none_or(|byte| begins_number(*byte)) {
        return false;
    }
    let cells: Vec<String> = record.iter().map(cell_text).collect();
    are_names(&cells)
        && (is_known(&cells, &head.written) || has_time(&cells))
        && trimmed(&cells) != trimmed(&head.written)
}

fn begins_number(byte: u8) -> bool {
    byte.is_ascii_digit() || b"+-.,".contains(&byte)
}

fn is_known(cells: &[String], head: &[String]) -> bool {
    cells.iter().any(|cell| !cell.is_empty() && head.contains(cell))
}

/// Whether names are those of a table: a time among two others at least.
fn has_time(cells: &[String]) -> bool {
    cells.len() > 2 && cells.iter().any(|cell| label(cell, None).is_time)
}

/// Whether a line has names alone, as a header has.
pub fn is_header(line: &[u8]) -> bool {
    are_names(&cells(line))
}

/// Whether a line below rows of numbers is one of words that are no header of theirs: none of its cells is known.
pub fn is_aside(above: &[u8], line: &[u8]) -> bool {
    let own = cells(line);
    let lines = || above.split(|byte| *byte == b'\n');
    let known = |above: &[u8]| is_known(&own, &cells(above));
    let is_row = |above: &[u8]| above.trim_ascii_start().first().is_some_and(|byte| begins_number(*byte));
    are_names(&own) && !has_time(&own) && lines().any(is_row) && !lines().any(known)
}

/// Without the empty cells that separators at the end make.
fn trimmed(cells: &[String]) -> &[String] {
    let last = cells.iter().rposition(|cell| !cell.is_empty());
    &cells[..last.map_or(0, |last| last + 1)]
}

/// Where another header begins in the first lines of a table, bytes: names alone below a row of numbers, one of them
/// known from above or a time, and not the same ones.
pub fn other_header(lines: &[u8]) -> Option<usize> {
    let mut heads: Vec<Vec<String>> = Vec::new();
    let (mut at, mut has_rows) = (0, false);
    for line in lines.split_inclusive(|byte| *byte == b'\n') {
        let cells = cells(line);
        if are_names(&cells) {
            let known = |head: &Vec<String>| is_known(&cells, head);
            let same = |head: &Vec<String>| trimmed(head) == trimmed(&cells);
            if !has_rows {
                heads.push(cells);
            } else if (heads.iter().any(known) || has_time(&cells)) && !heads.iter().any(same) {
                return Some(at);
            }
        } else {
            has_rows |= line.trim_ascii_start().first().is_some_and(|byte| begins_number(*byte));
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
