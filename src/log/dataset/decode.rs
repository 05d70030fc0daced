//! The wanted columns of a Parquet file as a table.

use std::{io::Read, path::Path};

use ::parquet::{
    column::reader::{ColumnReader, ColumnReaderImpl},
    data_type::DataType,
    errors::{ParquetError, Result},
    file::reader::{FileReader, RowGroupReader, SerializedFileReader},
};
use bytes::Bytes;

use super::{Cell, Column, DatasetError, Kind, Table};
use crate::{input_file, log::foreign::guarded};

/// More rows than this a byte of the file are none of ours.
const MOST_ROWS: usize = 1000;

/// Reads some columns of a table, in the order asked for.
///
/// # Errors
///
/// [`DatasetError`] if the file cannot be read, or lacks a column of that name and kind.
pub fn read_table(path: &Path, columns: &[Column]) -> std::result::Result<Table, DatasetError> {
    let form = |reason: String| DatasetError::Form { path: path.to_owned(), reason };
    let mut bytes = Vec::new();
    input_file::open(path)
        .and_then(|mut file| file.read_to_end(&mut bytes))
        .map_err(|source| DatasetError::File { path: path.to_owned(), source })?;
    let columns = columns.to_vec();
    let rows = guarded({
        let columns = columns.clone();
        move || rows(bytes, &columns)
    });
    match rows {
        Some(Ok(rows)) => Ok(Table { columns, rows }),
        Some(Err(error)) => Err(form(error.to_string())),
        None => Err(form("it is broken".to_owned())),
    }
}

fn rows(bytes: Vec<u8>, columns: &[Column]) -> Result<Vec<Vec<Cell>>> {
    let most = bytes.len().saturating_mul(MOST_ROWS);
    let reader = SerializedFileReader::new(Bytes::from(bytes))?;
    let schema = reader.metadata().file_metadata().schema_descr_ptr();
    let place = |column: &Column| {
        let found = schema.columns().iter().position(|known| known.name() == column.name);
        found.ok_or_else(|| ParquetError::General(format!("it has no column {}", column.name)))
    };
    let places = columns.iter().map(place).collect::<Result<Vec<usize>>>()?;
    let mut rows: Vec<Vec<Cell>> = Vec::new();
    for group in 0..reader.num_row_groups() {
        let group = reader.get_row_group(group)?;
        let count = usize::try_from(group.metadata().num_rows()).unwrap_or(0);
        if rows.len().saturating_add(count) > most {
            return Err(ParquetError::General(format!("it says that it holds more than {most} rows")));
        }
        let start = rows.len();
        rows.resize_with(start + count, Vec::new);
        for (column, place) in columns.iter().zip(&places) {
            let cells = cells(group.as_ref(), *place, column, count)?;
            rows[start..].iter_mut().zip(cells).for_each(|(row, cell)| row.push(cell));
        }
    }
    Ok(rows)
}

fn cells(group: &dyn RowGroupReader, place: usize, column: &Column, count: usize) -> Result<Vec<Cell>> {
    match (group.get_column_reader(place)?, column.kind) {
        (ColumnReader::ByteArrayColumnReader(reader), Kind::Text) => {
            get(reader, count, |text| Ok(Cell::from(text.as_utf8()?)))
        }
        (ColumnReader::DoubleColumnReader(reader), Kind::Real) => {
            get(reader, count, |value| Ok(Cell::Real(*value)))
        }
        (ColumnReader::Int64ColumnReader(reader), Kind::Whole | Kind::Instant) => {
            get(reader, count, |value| Ok(Cell::Whole(*value)))
        }
        (ColumnReader::BoolColumnReader(reader), Kind::Flag) => {
            get(reader, count, |value| Ok(Cell::Flag(*value)))
        }
        _ => Err(ParquetError::General(format!("its column {} holds something else", column.name))),
    }
}

fn get<T: DataType>(
    mut reader: ColumnReaderImpl<T>,
    count: usize,
    cell: impl Fn(&T::T) -> Result<Cell>,
) -> Result<Vec<Cell>> {
    let (mut levels, mut values) = (Vec::with_capacity(count), Vec::with_capacity(count));
    reader.read_records(count, Some(&mut levels), None, &mut values)?;
    let mut values = values.iter();
    let mut cells = Vec::with_capacity(count);
    for level in levels {
        cells.push(if level == 0 { Cell::None } else { values.next().map_or(Ok(Cell::None), &cell)? });
    }
    if cells.len() == count {
        return Ok(cells);
    }
    Err(ParquetError::General(format!("a column has {} of {count} rows", cells.len())))
}
