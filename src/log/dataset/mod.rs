//! Tables of a dataset as Parquet files: text, numbers, flags and instants, any of which may be absent.

mod decode;
mod encode;

use std::path::PathBuf;

use ::parquet::errors::ParquetError;
use thiserror::Error;

pub use decode::read_table;

/// A column of a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Column {
    /// Its name, with the unit.
    pub name: &'static str,
    /// What its cells hold.
    pub kind: Kind,
}

/// What the cells of a column hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// UTF-8.
    Text,
    /// A number.
    Real,
    /// A whole number.
    Whole,
    /// Yes or no.
    Flag,
    /// Microseconds since 1970, UTC.
    Instant,
}

/// A cell.
#[derive(Debug, Clone, PartialEq)]
pub enum Cell {
    /// Nothing is known.
    None,
    /// UTF-8.
    Text(String),
    /// A number; NaN is written as none.
    Real(f64),
    /// A whole number, or microseconds since 1970.
    Whole(i64),
    /// Yes or no.
    Flag(bool),
}

/// Rows under columns: `[rows][columns]`.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// The columns.
    pub columns: Vec<Column>,
    /// A cell for each column.
    pub rows: Vec<Vec<Cell>>,
}

/// Why a table was not written or read.
#[derive(Debug, Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the message says what each field is")]
pub enum DatasetError {
    #[error("cannot read {}", path.display())]
    File { path: PathBuf, source: std::io::Error },
    #[error("{} is no table of this dataset: {reason}", path.display())]
    Form { path: PathBuf, reason: String },
    #[error("cannot make the Parquet table {name}")]
    Encode { name: &'static str, source: ParquetError },
}

impl Column {
    /// Of texts.
    pub const fn text(name: &'static str) -> Self {
        Self { name, kind: Kind::Text }
    }

    /// Of numbers.
    pub const fn real(name: &'static str) -> Self {
        Self { name, kind: Kind::Real }
    }

    /// Of whole numbers.
    pub const fn whole(name: &'static str) -> Self {
        Self { name, kind: Kind::Whole }
    }

    /// Of flags.
    pub const fn flag(name: &'static str) -> Self {
        Self { name, kind: Kind::Flag }
    }

    /// Of instants.
    pub const fn instant(name: &'static str) -> Self {
        Self { name, kind: Kind::Instant }
    }
}

impl Cell {
    /// The text of a cell that holds one.
    pub fn as_text(&self) -> Option<&str> {
        if let Self::Text(text) = self { Some(text) } else { None }
    }

    /// The number of a cell that holds one.
    pub fn as_real(&self) -> Option<f64> {
        match self {
            Self::Real(value) => Some(*value),
            Self::Whole(value) => Some(*value as f64),
            _ => None,
        }
    }

    /// The whole number of a cell that holds one.
    pub fn as_whole(&self) -> Option<i64> {
        if let Self::Whole(value) = self { Some(*value) } else { None }
    }

    /// Whether it holds yes.
    pub fn is_set(&self) -> bool {
        matches!(self, Self::Flag(true))
    }
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

impl From<f64> for Cell {
    fn from(value: f64) -> Self {
        if value.is_finite() { Self::Real(value) } else { Self::None }
    }
}

impl From<usize> for Cell {
    fn from(value: usize) -> Self {
        Self::Whole(i64::try_from(value).unwrap_or(i64::MAX))
    }
}

impl From<u64> for Cell {
    fn from(value: u64) -> Self {
        Self::Whole(i64::try_from(value).unwrap_or(i64::MAX))
    }
}

impl From<bool> for Cell {
    fn from(value: bool) -> Self {
        Self::Flag(value)
    }
}

impl<T: Into<Cell>> From<Option<T>> for Cell {
    fn from(value: Option<T>) -> Self {
        value.map_or(Self::None, Into::into)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const COLUMNS: [Column; 5] = [
        Column::text("name"),
        Column::real("value_s"),
        Column::whole("count"),
        Column::flag("kept"),
        Column::instant("started_at"),
    ];

    fn table() -> Table {
        let row = |k: i64| {
            let some = k % 3 != 0;
            let cell = |cell: Cell| if some { cell } else { Cell::None };
            vec![
                Cell::from(format!("row {k}").as_str()),
                cell(Cell::from(0.1 * k as f64)),
                Cell::Whole(k),
                cell(Cell::from(k % 2 == 0)),
                cell(Cell::Whole(1_700_000_000_000_000 + k)),
            ]
        };
        Table { columns: COLUMNS.to_vec(), rows: (0..1000).map(row).collect() }
    }

    #[test]
    fn a_table_is_read_as_it_was_written_column_by_column() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.parquet");
        std::fs::write(&path, table().encode("a").unwrap()).unwrap();
        assert_eq!(read_table(&path, &COLUMNS).unwrap(), table());
        let some = read_table(&path, &[COLUMNS[2], COLUMNS[0]]).unwrap();
        assert_eq!(some.rows[7], [Cell::Whole(7), Cell::from("row 7")]);
        let empty = Table { rows: Vec::new(), ..table() };
        std::fs::write(&path, empty.encode("a").unwrap()).unwrap();
        assert_eq!(read_table(&path, &COLUMNS).unwrap(), empty);
    }

    #[test]
    fn what_is_no_such_table_is_an_error_and_never_a_panic() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.parquet");
        let whole = table().encode("a").unwrap();
        assert!(matches!(read_table(&path, &COLUMNS), Err(DatasetError::File { .. })));
        for cut in [0, 4, 100, whole.len() - 9] {
            std::fs::write(&path, &whole[..cut]).unwrap();
            assert!(matches!(read_table(&path, &COLUMNS), Err(DatasetError::Form { .. })), "{cut}");
        }
        for at in (0..whole.len()).step_by(97) {
            let mut broken = whole.clone();
            broken[at] ^= 0x55;
            std::fs::write(&path, &broken).unwrap();
            let _ = read_table(&path, &COLUMNS);
        }
        std::fs::write(&path, &whole).unwrap();
        let other = [Column::real("missing")];
        let error = read_table(&path, &other).unwrap_err().to_string();
        assert!(error.contains("no column missing"), "{error}");
        assert!(read_table(&path, &[Column::real("name")]).is_err());
    }
}
