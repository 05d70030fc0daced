//! A header in mid-table: the same again says nothing, another one gives the columns another meaning.

use ::csv::ByteRecord;

use super::{
    head::{Head, are_names},
    rows::cell_text,
};

/// Whether a row below the header is another header: names alone, one of them known, and not the same ones.
pub(super) fn is_another_header(head: &Head, record: &ByteRecord) -> bool {
    let mut cells: Vec<String> = record.iter().map(cell_text).collect();
    while cells.last().is_some_and(String::is_empty) {
        cells.pop();
    }
    let same = head.names.len() >= cells.len()
        && head.names.iter().zip(&cells).all(|(name, cell)| name == cell)
        && head.names[cells.len()..].iter().all(|name| name.starts_with("column_"));
    head.named && !same && are_names(&cells) && cells.iter().any(|cell| head.names.contains(cell))
}
