//! Parquet tables as text, to be read as any other table.

use std::io::Write;

use ::parquet::{
    errors::Result,
    file::reader::{FileReader, SerializedFileReader},
    record::Field,
};
use bytes::Bytes;

use crate::log::file::Source;

/// The rows below the names of their columns; a cell that is no number, text or instant is empty.
pub(super) fn table(source: &Source) -> Result<Vec<u8>> {
    let reader = SerializedFileReader::new(Bytes::from(source.whole()?))?;
    let mut writer = ::csv::Writer::from_writer(Vec::new());
    let fields = reader.metadata().file_metadata().schema().get_fields();
    writer.write_record(fields.iter().map(|field| field.name())).map_err(other)?;
    let mut cell = Vec::new();
    for row in reader.get_row_iter(None)? {
        for (_, field) in row?.get_column_iter() {
            cell.clear();
            put(field, &mut cell)?;
            writer.write_field(&cell).map_err(other)?;
        }
        writer.write_record(None::<&[u8]>).map_err(other)?;
    }
    writer.into_inner().map_err(|error| other(error.into_error()))
}

/// Instants become ns since 1970.
fn put(field: &Field, cell: &mut Vec<u8>) -> std::io::Result<()> {
    match field {
        Field::Byte(value) => write!(cell, "{value}"),
        Field::Short(value) => write!(cell, "{value}"),
        Field::Int(value) => write!(cell, "{value}"),
        Field::Long(value) => write!(cell, "{value}"),
        Field::UByte(value) => write!(cell, "{value}"),
        Field::UShort(value) => write!(cell, "{value}"),
        Field::UInt(value) => write!(cell, "{value}"),
        Field::ULong(value) => write!(cell, "{value}"),
        Field::Float(value) if value.is_finite() => write!(cell, "{value}"),
        Field::Double(value) if value.is_finite() => write!(cell, "{value}"),
        Field::TimestampMillis(value) => write!(cell, "{}", value.saturating_mul(1_000_000)),
        Field::TimestampMicros(value) => write!(cell, "{}", value.saturating_mul(1_000)),
        Field::Str(text) => write!(cell, "{text}"),
        _ => Ok(()),
    }
}

fn other<E: std::error::Error + Send + Sync + 'static>(error: E) -> ::parquet::errors::ParquetError {
    ::parquet::errors::ParquetError::External(Box::new(error))
}
