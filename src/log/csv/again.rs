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
    // Units may stand below the header that comes again, too.
    let is_units = head.units.as_ref().is_some_and(|units| trimmed(&cells) == trimmed(units));
    are_names(&cells)
        && !is_units
        && (is_known(&cells, &head.written) || begins_with_time(&cells, trimmed(&head.written).len()))
        && trimmed(&cells) != trimmed(&head.written)
}

fn begins_number(byte: u8) -> bool {
    byte.is_ascii_digit() || b"+-.,".contains(&byte)
}

fn is_known(cells: &[String], head: &[String]) -> bool {
    cells.iter().any(|cell| !cell.is_empty() && head.contains(cell))
}

/// Whether names are those of a table as wide as another one, a time first; a sentence has other signs and other lengths.
fn begins_with_time(cells: &[String], width: usize) -> bool {
    let is_word = |cell: &String| cell.chars().all(|c| c.is_alphanumeric() || "_[]()./".contains(c));
    let cells = trimmed(cells);
    cells.len() > 2
        && cells.len() == width
        && cells.iter().all(is_word)
        && cells.first().is_some_and(|first| label(first, None).is_time)
}

/// Whether most cells of a line are numbers.
fn is_row(cells: &[String]) -> bool {
    let numbers = cells.iter().filter(|cell| cell.replace(',', ".").parse::<f64>().is_ok()).count();
    cells.len() > 1 && 2 * numbers > cells.len()
}

/// Whether a line has names alone, as a header has.
pub fn is_header(line: &[u8]) -> bool {
    are_names(&cells(line))
}

/// Whether a line below a header and rows of numbers is one of words that are no header of theirs: none of its cells is known.
pub fn is_aside(above: &[u8], line: &[u8]) -> bool {
    let own = cells(line);
    if !are_names(&own) {
        return false;
    }
    let lines: Vec<Vec<String>> = above.split(|byte| *byte == b'\n').map(cells).collect();
    let as_wide = |cells: &&Vec<String>| cells.len() == own.len();
    let head = lines.iter().position(|cells| as_wide(&cells) && are_names(cells));
    head.is_some_and(|head| lines[head..].iter().filter(as_wide).any(|cells| is_row(cells)))
        && !begins_with_time(&own, own.len())
        && !lines.iter().any(|above| is_known(&own, above))
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
            } else if heads.iter().any(|head| known(head) || begins_with_time(&cells, trimmed(head).len()))
                && !heads.iter().any(same)
            {
                return Some(at);
            }
        } else {
            let first = line.trim_ascii_start().first();
            has_rows |= first.is_some_and(u8::is_ascii_digit)
                || first.is_some_and(|byte| begins_number(*byte)) && is_row(&cells);
        }
        at += line.len();
    }
    None
}

/// The cells of a line by the separator that makes the most of them.
fn cells(line: &[u8]) -> Vec<String> {
    let line = line.trim_ascii_end();
    let pieces = |separator: u8| memchr::memchr_iter(separator, line).count();
    // Blanks stand within names, too.
    let marks = [b';', b'\t', b',', b'|'].into_iter().rev().max_by_key(|one| pieces(*one));
    let separator = marks.filter(|one| pieces(*one) > 0).or(Some(b' '));
    line.split(|byte| Some(*byte) == separator).map(cell_text).collect()
}
