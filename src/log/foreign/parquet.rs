//! Parquet tables as text, to be read as any other table.

use std::{
    io::Write,
    panic::{self, UnwindSafe},
    sync::{Mutex, PoisonError},
};

use ::parquet::{
    basic::ConvertedType,
    errors::{ParquetError, Result},
    file::reader::{FileReader, SerializedFileReader},
    record::Field,
    schema::types::Type,
};
use bytes::Bytes;

use super::durations::{SCHEMA, units_ns};
use crate::log::file::Source;

/// The rows below the names of their columns; a cell that is no number, text or instant is empty. `nested`: values within
/// others are columns, too.
pub(super) fn table(source: &Source, nested: bool) -> Result<Vec<u8>> {
    let bytes = source.whole()?;
    guarded(move || rows(bytes, nested))
        .unwrap_or_else(|| Err(ParquetError::General("the file is broken".to_owned())))
        .map_err(|error| match error {
            // What the library says of a way to compress that is not built in.
            ParquetError::General(why) if why.contains("Disabled feature") => ParquetError::General(format!(
                "its columns are compressed in a way that is not read here ({}); write it with zstd, snappy, gzip or lz4",
                why.rsplit(' ').next().unwrap_or_default()
            )),
            error => error,
        })
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

fn rows(bytes: Vec<u8>, nested: bool) -> Result<Vec<u8>> {
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
    let file = reader.metadata().file_metadata();
    let beside = file.key_value_metadata().into_iter().flatten().find(|one| one.key == SCHEMA);
    let spans_ns = beside.and_then(|one| one.value.as_deref()).map(units_ns).unwrap_or_default();
    let fields = file.schema().get_fields();
    let mut columns: Vec<Vec<Leaf>> = fields.iter().map(|field| leaves(field, nested)).collect();
    for leaf in columns.iter_mut().flatten() {
        leaf.unit_ns = spans_ns.get(&leaf.name).copied();
    }
    let mut headed = false;
    let mut cell = Vec::new();
    for row in reader.get_row_iter(None)? {
        let row = row?;
        if !headed {
            for ((_, field), leaves) in row.get_column_iter().zip(&mut columns) {
                for leaf in leaves {
                    leaf.width = width(leaf.of(field));
                }
            }
            writer.write_record(columns.iter().flatten().flat_map(Leaf::headers)).map_err(other)?;
            headed = true;
        }
        for ((_, field), leaves) in row.get_column_iter().zip(&columns) {
            for leaf in leaves {
                let elements = match leaf.of(field) {
                    Field::ListInternal(list) => list.elements(),
                    one => std::slice::from_ref(one),
                };
                for at in 0..leaf.width.unwrap_or(1) {
                    cell.clear();
                    let element = elements.get(at).map(|element| leaf.member(element));
                    element.map_or(Ok(()), |element| put(element, leaf.unit_ns, &mut cell))?;
                    writer.write_field(&cell).map_err(other)?;
                }
            }
        }
        writer.write_record(None::<&[u8]>).map_err(other)?;
    }
    if !headed {
        writer.write_record(columns.iter().flatten().map(|leaf| &leaf.name)).map_err(other)?;
    }
    writer.into_inner().map_err(|error| other(error.into_error()))
}

/// A value of each row that holds no others by name.
struct Leaf {
    /// Of a value within another, behind the name of that one and a point.
    name: String,
    /// The places in those that it is within, from the outermost on.
    path: Vec<usize>,
    /// Elements of a list are columns of their own, as many as the first row has.
    width: Option<usize>,
    /// Its name and place in each element, where those are values by name.
    member: Option<(String, usize)>,
    /// Nanoseconds of one, if it is a duration.
    unit_ns: Option<i64>,
}

impl Leaf {
    /// Its value in the outermost one.
    fn of<'a>(&self, field: &'a Field) -> &'a Field {
        self.path.iter().fold(field, |field, at| within(field, *at))
    }

    /// Its value in an element of a list.
    fn member<'a>(&self, element: &'a Field) -> &'a Field {
        self.member.as_ref().map_or(element, |(_, at)| within(element, *at))
    }

    fn headers(&self) -> Vec<String> {
        let Some(width) = self.width else { return vec![self.name.clone()] };
        let member = self.member.as_ref().map(|(name, _)| format!(".{name}")).unwrap_or_default();
        (0..width).map(|at| format!("{}[{at}]{member}", self.name)).collect()
    }
}

/// A value in another by its place.
fn within(field: &Field, at: usize) -> &Field {
    match field {
        Field::Group(row) => row.get_column_iter().nth(at).map_or(&Field::Null, |(_, field)| field),
        _ => &Field::Null,
    }
}

/// The names of the values in each element of a list, where those are values by name.
fn members(list: &Type) -> Option<Vec<String>> {
    if !list.is_group() || list.get_basic_info().converted_type() != ConvertedType::LIST {
        return None;
    }
    let of = |of: &Type| -> Option<Vec<String>> {
        of.is_group().then(|| of.get_fields().iter().map(|field| field.name().to_owned()).collect())
    };
    let repeated = list.get_fields().first().filter(|repeated| repeated.is_group())?;
    match repeated.get_fields() {
        [element] => of(element),
        _ => of(repeated),
    }
}

/// The values of a column; `nested`: those within its values, too.
fn leaves(of: &Type, nested: bool) -> Vec<Leaf> {
    let info = of.get_basic_info();
    let plain = info.logical_type_ref().is_none() && info.converted_type() == ConvertedType::NONE;
    if !(nested && of.is_group() && plain) {
        let leaf = |member: Option<(String, usize)>| Leaf {
            name: of.name().to_owned(),
            path: Vec::new(),
            width: None,
            member,
            unit_ns: None,
        };
        return match members(of) {
            Some(members) => (0..).zip(members).map(|(at, name)| leaf(Some((name, at)))).collect(),
            None => vec![leaf(None)],
        };
    }
    let within = of.get_fields().iter().enumerate().flat_map(|(at, field)| {
        leaves(field, nested).into_iter().map(move |mut leaf| {
            leaf.path.insert(0, at);
            leaf
        })
    });
    within.map(|leaf| Leaf { name: format!("{}.{}", of.name(), leaf.name), ..leaf }).collect()
}

fn width(field: &Field) -> Option<usize> {
    match field {
        Field::ListInternal(list) => Some(list.len()),
        _ => None,
    }
}

/// Instants become ns since 1970, durations days and a time; `unit_ns` is that of a whole number that is one.
fn put(field: &Field, unit_ns: Option<i64>, cell: &mut Vec<u8>) -> std::io::Result<()> {
    match field {
        Field::Long(value) if unit_ns.is_some() => put_span(*value, unit_ns.unwrap_or(1), cell),
        Field::TimeMillis(value) => put_span(i64::from(*value), 1_000_000, cell),
        Field::TimeMicros(value) => put_span(*value, 1_000, cell),
        Field::Float16(value) if value.to_f32().is_finite() => write!(cell, "{}", value.to_f32()),
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
        Field::Decimal(value) => put_decimal(value.data(), value.scale(), cell),
        _ => Ok(()),
    }
}

/// A whole number, its most significant byte first, with so many of its digits behind the point. One of more than 16 bytes is none of a
/// joint.
fn put_decimal(bytes: &[u8], scale: i32, cell: &mut Vec<u8>) -> std::io::Result<()> {
    let (Some(first), Ok(scale @ 0..=38)) =
        (bytes.first().filter(|_| bytes.len() <= 16), u32::try_from(scale))
    else {
        return Ok(());
    };
    let fill = if first & 0x80 == 0 { 0 } else { 0xff };
    let mut whole = [fill; 16];
    whole[16 - bytes.len()..].copy_from_slice(bytes);
    let value = i128::from_be_bytes(whole);
    let (sign, one) = (if value < 0 { "-" } else { "" }, 10_u128.pow(scale));
    let (above, below) = (value.unsigned_abs() / one, value.unsigned_abs() % one);
    match scale {
        0 => write!(cell, "{sign}{above}"),
        _ => write!(cell, "{sign}{above}.{below:0width$}", width = scale as usize),
    }
}

/// As data frames write a duration into text: `0 days 00:00:00.020000000`.
fn put_span(value: i64, unit_ns: i64, cell: &mut Vec<u8>) -> std::io::Result<()> {
    const SECOND_NS: i64 = 1_000_000_000;
    const DAY_S: i64 = 86_400;
    let ns = value.saturating_mul(unit_ns);
    let (s, ns) = (ns.div_euclid(SECOND_NS), ns.rem_euclid(SECOND_NS));
    let (days, s) = (s.div_euclid(DAY_S), s.rem_euclid(DAY_S));
    write!(cell, "{days} days {:02}:{:02}:{:02}.{ns:09}", s / 3600, s / 60 % 60, s % 60)
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
    fn a_decimal_keeps_its_digits() {
        let of = |bytes: &[u8], scale| {
            let mut cell = Vec::new();
            put_decimal(bytes, scale, &mut cell).unwrap();
            String::from_utf8(cell).unwrap()
        };
        assert_eq!(of(&12_345_i32.to_be_bytes(), 3), "12.345");
        assert_eq!(of(&(-5_i64).to_be_bytes(), 4), "-0.0005");
        assert_eq!(of(&[7], 0), "7");
        for (bytes, scale) in [(&[][..], 2), (&[1; 17], 2), (&[1], -1)] {
            assert_eq!(of(bytes, scale), "");
        }
    }

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
        let text = rows(writer.into_inner().unwrap(), true).unwrap();
        assert_eq!(String::from_utf8(text).unwrap(), "t,action[0],action[1]\n0,1,2\n0.5,3,\n");
    }

    #[test]
    fn elements_that_hold_values_by_name_are_columns_of_those() {
        let schema = "message run { required double t; required group joints (LIST) { repeated group list { \
                      required group element { required double set; required double act; } } } }";
        let schema = Arc::new(parse_message_type(schema).unwrap());
        let mut writer = SerializedFileWriter::new(Vec::new(), schema, Arc::default()).unwrap();
        let mut group = writer.next_row_group().unwrap();
        for values in [&[0.5][..], &[1.0, 2.0], &[3.0, 4.0]] {
            let mut column = group.next_column().unwrap().unwrap();
            let levels: Option<(&[i16], &[i16])> = (values.len() > 1).then_some((&[1, 1], &[0, 1]));
            let (depth, again) = levels.unzip();
            column.typed::<DoubleType>().write_batch(values, depth, again).unwrap();
            column.close().unwrap();
        }
        group.close().unwrap();
        let text = String::from_utf8(rows(writer.into_inner().unwrap(), false).unwrap()).unwrap();
        assert_eq!(text, "t,joints[0].set,joints[1].set,joints[0].act,joints[1].act\n0.5,1,2,3,4\n");
    }

    #[test]
    fn values_within_others_are_columns_where_they_are_asked_for() {
        let schema = "message run { required double t; optional group boom { required double set; required group \
                      state { optional double act; } } }";
        let schema = Arc::new(parse_message_type(schema).unwrap());
        let mut writer = SerializedFileWriter::new(Vec::new(), schema, Arc::default()).unwrap();
        let mut group = writer.next_row_group().unwrap();
        for (values, depth) in
            [(&[0.0, 0.5][..], None), (&[1.0][..], Some([0, 1])), (&[2.0][..], Some([0, 2]))]
        {
            let mut column = group.next_column().unwrap().unwrap();
            let depth = depth.as_ref().map(<[i16; 2]>::as_slice);
            column.typed::<DoubleType>().write_batch(values, depth, None).unwrap();
            column.close().unwrap();
        }
        group.close().unwrap();
        let bytes = writer.into_inner().unwrap();
        let of = |nested| String::from_utf8(rows(bytes.clone(), nested).unwrap()).unwrap();
        assert_eq!(of(false), "t,boom\n0,\n0.5,\n");
        assert_eq!(of(true), "t,boom.set,boom.state.act\n0,,\n0.5,1,2\n");
    }
}
