//! Parquet tables as text, to be read as any other table.

use std::{
    io::Write,
    panic::{self, UnwindSafe},
    sync::{Mutex, PoisonError},
};

use ::parquet::{
    errors::{ParquetError, Result},
    file::reader::{FileReader, SerializedFileReader},
    record::Field,
};
use bytes::Bytes;

use crate::log::file::Source;

/// The rows below the names of their columns; a cell that is no number, text or instant is empty.
pub(super) fn table(source: &Source) -> Result<Vec<u8>> {
    let bytes = source.whole()?;
    guarded(move || rows(bytes))
        .unwrap_or_else(|| Err(ParquetError::General("the file is broken".to_owned())))
}

/// The library panics on some broken files; `None` then. What other threads have to say of a panic of theirs is
/// lost meanwhile.
pub(in crate::log) fn guarded<T>(read: impl FnOnce() -> T + UnwindSafe) -> Option<T> {
    static ONE: Mutex<()> = Mutex::new(());
    let _one = ONE.lock().unwrap_or_else(PoisonError::into_inner);
    let usual = panic::take_hook();
    panic::set_hook(Box::new(|_| {}));
    let done = panic::catch_unwind(read);
    panic::set_hook(usual);
    done.ok()
}

/// More rows or bytes than this for each byte of the file are no table of a run.
const MOST_TIMES: i64 = 1000;

fn rows(bytes: Vec<u8>) -> Result<Vec<u8>> {
    let most = i64::try_from(bytes.len()).unwrap_or(i64::MAX).saturating_mul(MOST_TIMES);
    let reader = SerializedFileReader::new(Bytes::from(bytes))?;
    let groups = reader.metadata().row_groups().iter();
    let said = groups.map(|group| group.total_byte_size().max(group.num_rows()).max(0));
    if said.fold(0_i64, i64::saturating_add) > most {
        return Err(ParquetError::General(format!(
            "it says that it holds more than {MOST_TIMES} times its bytes"
        )));
    }
    let mut writer = ::csv::Writer::from_writer(Vec::new());
    let fields = reader.metadata().file_metadata().schema().get_fields();
    let names: Vec<&str> = fields.iter().map(|field| field.name()).collect();
    let mut widths: Option<Vec<Option<usize>>> = None;
    let mut cell = Vec::new();
    for row in reader.get_row_iter(None)? {
        let row = row?;
        if widths.is_none() {
            let found: Vec<Option<usize>> = row.get_column_iter().map(|(_, field)| width(field)).collect();
            writer.write_record(headers(&names, &found)).map_err(other)?;
            widths = Some(found);
        }
        for ((_, field), width) in row.get_column_iter().zip(widths.iter().flatten()) {
            let elements = match field {
                Field::ListInternal(list) => list.elements(),
                one => std::slice::from_ref(one),
            };
            for at in 0..width.unwrap_or(1) {
                cell.clear();
                elements.get(at).map_or(Ok(()), |element| put(element, &mut cell))?;
                writer.write_field(&cell).map_err(other)?;
            }
        }
        writer.write_record(None::<&[u8]>).map_err(other)?;
    }
    if widths.is_none() {
        writer.write_record(&names).map_err(other)?;
    }
    writer.into_inner().map_err(|error| other(error.into_error()))
}

/// Elements of a list are columns of their own, as many as the first row has.
fn width(field: &Field) -> Option<usize> {
    match field {
        Field::ListInternal(list) => Some(list.len()),
        _ => None,
    }
}

fn headers(names: &[&str], widths: &[Option<usize>]) -> Vec<String> {
    let of = |(name, width): (&&str, &Option<usize>)| match *width {
        Some(width) => (0..width).map(|at| format!("{name}[{at}]")).collect(),
        None => vec![(*name).to_owned()],
    };
    names.iter().zip(widths).flat_map(of).collect()
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

fn other<E: std::error::Error + Send + Sync + 'static>(error: E) -> ParquetError {
    ParquetError::External(Box::new(error))
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use ::parquet::{
        data_type::DoubleType, file::writer::SerializedFileWriter, schema::parser::parse_message_type,
    };

    use super::*;

    #[test]
    fn elements_of_lists_are_columns() {
        let schema = "message run { required double t; required group action (LIST) { repeated group list { \
                      required double element; } } }";
        let schema = Arc::new(parse_message_type(schema).unwrap());
        let mut writer = SerializedFileWriter::new(Vec::new(), schema, Arc::default()).unwrap();
        let mut group = writer.next_row_group().unwrap();
        let mut put = |values: &[f64], levels: Option<(&[i16], &[i16])>| {
            let mut column = group.next_column().unwrap().unwrap();
            let (depth, again) = levels.unzip();
            column.typed::<DoubleType>().write_batch(values, depth, again).unwrap();
            column.close().unwrap();
        };
        put(&[0.0, 0.5], None);
        put(&[1.0, 2.0, 3.0], Some((&[1, 1, 1], &[0, 1, 0])));
        group.close().unwrap();
        let text = rows(writer.into_inner().unwrap()).unwrap();
        assert_eq!(String::from_utf8(text).unwrap(), "t,action[0],action[1]\n0,1,2\n0.5,3,\n");
    }
}
