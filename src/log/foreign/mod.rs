//! Files of other forms, each made a log before anything else sees it: packed files, ROS 2 bags in SQLite, tables.

#[cfg(feature = "parquet")]
mod durations;
mod packed;
#[cfg(feature = "parquet")]
mod parquet;
#[cfg(feature = "sqlite")]
mod sqlite;
mod table;
#[cfg(feature = "sqlite")]
mod undescribed;

use std::{io, path::Path};

#[cfg(feature = "parquet")]
pub(super) use parquet::guarded;

use super::{
    csv::{CsvError, CsvOptions, CsvRun, read_csv_bytes},
    error::LogError,
    file::Source,
    looks::{LOOKED_AT, is_document, is_table},
    unread::unread,
};
use crate::remark::Remarks;

/// First bytes of forms.
#[cfg(feature = "sqlite")]
const SQLITE: &[u8] = b"SQLite format 3\0";
#[cfg(feature = "parquet")]
const PARQUET: &[u8] = b"PAR1";

/// What is open as a log, whatever its form; what is no form known here is left as it is.
pub(super) fn log_of(
    path: &Path,
    source: Source,
    columns: &CsvOptions,
    remarks: &mut Remarks,
) -> Result<Source, LogError> {
    let source = packed::unpacked(source).map_err(LogError::file("open", path))?;
    let mut start = Vec::new();
    source.read(LOOKED_AT, &mut start).map_err(LogError::file("read", path))?;
    match start.as_slice() {
        #[cfg(feature = "sqlite")]
        bytes if bytes.starts_with(SQLITE) => sqlite::log(path, &source, remarks),
        #[cfg(feature = "parquet")]
        bytes if bytes.starts_with(PARQUET) => plain_or_nested(
            |nested| {
                parquet::table(&source, nested)
                    .map_err(|error| LogError::Form { path: path.to_owned(), reason: error.to_string() })
            },
            |text| table::log(path, text, columns, remarks),
        ),
        bytes
            if unread(bytes).is_none()
                && [is_table, is_document].iter().any(|is| is(&packed::name_within(path), bytes)) =>
        {
            let text = source.whole().map_err(LogError::file("read", path))?;
            table::log(path, &text, columns, remarks)
        }
        _ => Ok(source),
    }
}

/// Reads a CSV file, or another table: packed by gzip or zstd, or in Parquet.
///
/// # Errors
///
/// [`CsvError`], which says what the file lacks and which option gives it.
pub fn read_csv(path: &Path, options: &CsvOptions) -> Result<CsvRun, CsvError> {
    let fault = |source| CsvError::File { path: path.to_owned(), source };
    // A table may be packed whole.
    let source = Source::open(path).and_then(packed::unpacked).map_err(fault)?;
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    plain_or_nested(
        |nested| table_text(&source, nested).map_err(fault),
        |text| read_csv_bytes(&name, text, options).map_err(|error| error.at(path)),
    )
}

/// What is read of a table's text; where that fails, of one in which values within its values are columns, too.
fn plain_or_nested<T, E>(
    text: impl Fn(bool) -> Result<Vec<u8>, E>,
    mut read: impl FnMut(&[u8]) -> Result<T, E>,
) -> Result<T, E> {
    let plain = text(false)?;
    read(&plain).or_else(|error| {
        let nested = text(true)?;
        if nested == plain { Err(error) } else { read(&nested) }
    })
}

/// The text of a table in text or in Parquet; `nested`: of values within others, too.
#[cfg_attr(not(feature = "parquet"), expect(unused_variables, reason = "text has no values within others"))]
fn table_text(source: &Source, nested: bool) -> io::Result<Vec<u8>> {
    #[cfg(feature = "parquet")]
    {
        let mut start = Vec::new();
        source.read(LOOKED_AT, &mut start)?;
        if start.starts_with(PARQUET) {
            return parquet::table(source, nested).map_err(io::Error::other);
        }
    }
    source.whole()
}
