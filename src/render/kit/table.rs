//! A table: columns that say what they hold, and cells.

use std::borrow::Cow;

/// A column.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Column {
    /// Its heading, with the unit.
    pub heading: Cow<'static, str>,
    /// To which side its cells go.
    pub align: Align,
    /// A sentence on what it holds, shown where a page is pointed at; empty if the heading says it all.
    pub meaning: &'static str,
    /// Whether its heading goes on from that of the column before it: nothing parts them.
    pub goes_on: bool,
}

/// To which side cells go.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Align {
    /// Words.
    Left,
    /// Numbers.
    Right,
}

impl Column {
    /// Of words.
    pub fn words(heading: impl Into<Cow<'static, str>>) -> Self {
        Self { heading: heading.into(), align: Align::Left, meaning: "", goes_on: false }
    }

    /// Of numbers.
    pub fn numbers(heading: impl Into<Cow<'static, str>>) -> Self {
        Self { align: Align::Right, ..Self::words(heading) }
    }

    /// With a heading that goes on from that of the column before.
    pub fn going_on(self) -> Self {
        Self { goes_on: true, ..self }
    }

    /// With what it holds.
    pub fn meaning(self, meaning: &'static str) -> Self {
        Self { meaning, ..self }
    }
}

/// Rows of cells under columns.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Table {
    /// In order.
    pub columns: Vec<Column>,
    /// A cell for each column.
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// Columns of words, then columns of numbers, by their headings.
    pub fn new(
        words: &[&'static str],
        numbers: &[&'static str],
        rows: impl IntoIterator<Item = Vec<String>>,
    ) -> Self {
        let words = words.iter().map(|heading| Column::words(*heading));
        Self::of(words.chain(numbers.iter().map(|heading| Column::numbers(*heading))), rows)
    }

    /// Any columns.
    pub fn of(
        columns: impl IntoIterator<Item = Column>,
        rows: impl IntoIterator<Item = Vec<String>>,
    ) -> Self {
        Self { columns: columns.into_iter().collect(), rows: rows.into_iter().collect() }
    }

    /// The same with these columns only.
    pub(super) fn part(&self, columns: &[usize]) -> Self {
        let row = |row: &Vec<String>| columns.iter().filter_map(|k| row.get(*k).cloned()).collect();
        Self {
            columns: columns.iter().filter_map(|k| self.columns.get(*k).cloned()).collect(),
            rows: self.rows.iter().map(row).collect(),
        }
    }
}
