//! CSV files of controllers (PLC traces, RTDE recordings, exports): what their columns are, and
//! the log that they become.
//!
//! `dialect` finds separator and decimal mark, `head` the names above the numbers, `label` what a
//! name says, `clock` which column is the time, `layout` which column is which joint's; `read` then walks all
//! rows. What a file does not say, [`CsvOptions`] do; what is only guessed is a remark.

mod angle;
mod clock;
mod column;
mod date;
mod dialect;
mod error;
mod head;
mod label;
mod layout;
mod number;
mod options;
mod read;
mod rows;
mod run;
mod text;
mod time;
mod understood;
mod unit;
mod word;

use std::path::Path;

pub use error::CsvError;
pub use options::{AngleUnit, Columns, CsvOptions, Separator};
pub use run::CsvRun;
pub use understood::{ColumnRead, TimeRead, Understood};

use super::{file::Source, write::Role};
use crate::remark::Remarks;

/// The quantity of a joint that a column holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Quantity {
    /// Its angle.
    Position,
    /// Its speed.
    Velocity,
}

/// Reads a CSV file.
///
/// # Errors
///
/// [`CsvError`], which says what the file lacks and which option gives it.
pub fn read_csv(path: &Path, options: &CsvOptions) -> Result<CsvRun, CsvError> {
    let bytes = Source::open(path).and_then(|source| source.whole());
    let bytes = bytes.map_err(|source| CsvError::File { path: path.to_owned(), source })?;
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    read_csv_bytes(&name, &bytes, options)
}

/// As [`read_csv`] of a file in memory.
///
/// # Errors
///
/// [`CsvError`]
pub fn read_csv_bytes(name: &str, bytes: &[u8], options: &CsvOptions) -> Result<CsvRun, CsvError> {
    options.check()?;
    let text = text::of_bytes(name, bytes)?;
    let dialect = dialect::detect(name, &text, options)?;
    let head = head::read_head(&text, dialect);
    let below = |column: usize| head.units.as_ref().and_then(|units| units.get(column)).map(String::as_str);
    let names = head.names.iter().enumerate();
    let labels: Vec<label::Label> = names.map(|(column, name)| label::label(name, below(column))).collect();
    let mut remarks = Remarks::default();
    let time = clock::choose(&head, &labels, dialect, options, &mut remarks)?;
    let layout = layout::lay_out(&head, &labels, &time.columns(), options, &mut remarks)?;
    let wanted = layout.uses.iter().map(|one| one.column);
    let wanted = wanted.chain(layout.interfaces.iter().map(|one| one.column));
    let mut cells = read::read(&text, &head, dialect, &time, wanted, &mut remarks)?;
    let units = angle::to_si(&head, &labels, &layout, options, &mut cells, &mut remarks)?;
    let understood = Understood::new(name, dialect, &head, &time, &layout, &cells, &units);
    Ok(CsvRun::new(layout, cells, understood, remarks))
}
