//! A table as the bytes of a Parquet file.

use std::sync::Arc;

use ::parquet::{
    basic::{Compression, LogicalType, Repetition, TimeUnit, Type as PhysicalType, ZstdLevel},
    data_type::{BoolType, ByteArray, ByteArrayType, DataType, DoubleType, Int64Type},
    errors::{ParquetError, Result},
    file::{
        properties::{WriterProperties, WriterVersion},
        writer::{SerializedFileWriter, SerializedRowGroupWriter},
    },
    schema::types::{Type, TypePtr},
};

use super::{Cell, Column, DatasetError, Kind, Table};
use crate::document::PROGRAM;

impl Table {
    /// The bytes of a Parquet file, compressed with zstd, every column optional. Equal tables give equal bytes.
    ///
    /// # Errors
    ///
    /// [`DatasetError::Encode`].
    pub fn encode(&self, name: &'static str) -> std::result::Result<Vec<u8>, DatasetError> {
        self.bytes(name).map_err(|source| DatasetError::Encode { name, source })
    }

    fn bytes(&self, name: &'static str) -> Result<Vec<u8>> {
        let properties = WriterProperties::builder()
            .set_created_by(PROGRAM.to_owned())
            .set_writer_version(WriterVersion::PARQUET_1_0)
            .set_compression(Compression::ZSTD(ZstdLevel::default()))
            .build();
        let mut bytes = Vec::new();
        let mut file =
            SerializedFileWriter::new(&mut bytes, schema(name, &self.columns)?, Arc::new(properties))?;
        let mut group = file.next_row_group()?;
        for (k, column) in self.columns.iter().enumerate() {
            let cells = || self.rows.iter().map(move |row| row.get(k).unwrap_or(&Cell::None));
            match column.kind {
                Kind::Text => {
                    put::<ByteArrayType>(&mut group, cells().map(|cell| cell.as_text().map(ByteArray::from)))
                }
                Kind::Real => put::<DoubleType>(&mut group, cells().map(Cell::as_real)),
                Kind::Whole | Kind::Instant => put::<Int64Type>(&mut group, cells().map(Cell::as_whole)),
                Kind::Flag => put::<BoolType>(
                    &mut group,
                    cells().map(|cell| if let Cell::Flag(is) = cell { Some(*is) } else { None }),
                ),
            }?;
        }
        group.close()?;
        file.close()?;
        Ok(bytes)
    }
}

fn put<T: DataType>(
    group: &mut SerializedRowGroupWriter<'_, &mut Vec<u8>>,
    cells: impl Iterator<Item = Option<T::T>>,
) -> Result<()> {
    let (mut levels, mut values) = (Vec::new(), Vec::new());
    for cell in cells {
        levels.push(i16::from(cell.is_some()));
        values.extend(cell);
    }
    let missing = || ParquetError::General("no column to write".to_owned());
    let mut column = group.next_column()?.ok_or_else(missing)?;
    column.typed::<T>().write_batch(&values, Some(&levels), None)?;
    column.close()
}

fn schema(name: &str, columns: &[Column]) -> Result<TypePtr> {
    let field = |column: &Column| {
        let (physical, logical) = match column.kind {
            Kind::Text => (PhysicalType::BYTE_ARRAY, Some(LogicalType::String)),
            Kind::Real => (PhysicalType::DOUBLE, None),
            Kind::Whole => (PhysicalType::INT64, None),
            Kind::Flag => (PhysicalType::BOOLEAN, None),
            Kind::Instant => (PhysicalType::INT64, Some(LogicalType::timestamp(true, TimeUnit::MICROS))),
        };
        let of = Type::primitive_type_builder(column.name, physical);
        of.with_repetition(Repetition::OPTIONAL).with_logical_type(logical).build().map(Arc::new)
    };
    let fields = columns.iter().map(field).collect::<Result<_>>()?;
    Type::group_type_builder(name).with_fields(fields).build().map(Arc::new)
}
