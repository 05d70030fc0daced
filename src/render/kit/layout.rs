//! Cells of a table as lines of text, columns under one another.

use textwrap::core::display_width;

use super::{Align, Table};

pub(super) const GAP: &str = "  ";

/// Characters that each column takes.
pub(super) fn widths(table: &Table) -> Vec<usize> {
    let cell = |row: &[String], k: usize| row.get(k).map_or(0, |cell| display_width(cell));
    let widest =
        |(k, heading): (usize, usize)| table.rows.iter().map(|row| cell(row, k)).fold(heading, usize::max);
    table.columns.iter().map(|column| display_width(&column.heading)).enumerate().map(widest).collect()
}

/// Headings, then rows: each cell filled up to the width of its column.
pub(super) fn filled(table: &Table) -> Vec<Vec<String>> {
    let widths = widths(table);
    let fill = |k: usize, text: &str| {
        let blank = " ".repeat(widths[k].saturating_sub(display_width(text)));
        match table.columns[k].align {
            Align::Left => format!("{text}{blank}"),
            Align::Right => format!("{blank}{text}"),
        }
    };
    let headings = table.columns.iter().enumerate().map(|(k, column)| fill(k, &column.heading)).collect();
    let row = |row: &Vec<String>| {
        (0..table.columns.len()).map(|k| fill(k, row.get(k).map_or("", String::as_str))).collect()
    };
    std::iter::once(headings).chain(table.rows.iter().map(row)).collect()
}
