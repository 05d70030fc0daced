//! The table as a Parquet file.

use std::{io::Write, sync::Arc};

use ::parquet::{
    basic::{Compression, Repetition, Type as PhysicalType, ZstdLevel},
    data_type::{DoubleType, Int64Type},
    errors::ParquetError,
    file::{
        properties::{WriterProperties, WriterVersion},
        writer::{SerializedFileWriter, SerializedRowGroupWriter},
    },
    schema::types::{Type, TypePtr},
};

use super::{ExportError, RunTable};

/// Rows of a row group: readers hold one in memory.
const GROUP_ROWS: usize = 1 << 20;

impl RunTable {
    /// Writes a Parquet file, compressed with zstd: `stamp_ns` is INT64, all others DOUBLE, null
    /// where there is no sample. Equal runs give equal bytes.
    ///
    /// # Errors
    ///
    /// [`ExportError::Parquet`]
    pub fn write_parquet<W: Write + Send>(&self, output: W) -> Result<(), ExportError> {
        let properties = WriterProperties::builder()
            .set_created_by(concat!("hydrotrace ", env!("CARGO_PKG_VERSION")).to_owned())
            .set_writer_version(WriterVersion::PARQUET_1_0)
            .set_compression(Compression::ZSTD(ZstdLevel::default()))
            .build();
        let mut file = SerializedFileWriter::new(output, self.schema()?, Arc::new(properties))?;
        let mut from = 0;
        while from < self.rows() {
            let rows = from..self.rows().min(from + GROUP_ROWS);
            let mut group = file.next_row_group()?;
            let mut column =
                group.next_column()?.ok_or_else(|| ParquetError::General("no column to write".to_owned()))?;
            column.typed::<Int64Type>().write_batch(&self.stamp_ns[rows.clone()], None, None)?;
            column.close()?;
            column =
                group.next_column()?.ok_or_else(|| ParquetError::General("no column to write".to_owned()))?;
            column.typed::<DoubleType>().write_batch(&self.time_s[rows.clone()], None, None)?;
            column.close()?;
            for cells in &self.cells {
                optional(&mut group, &cells[rows.clone()])?;
            }
            group.close()?;
            from = rows.end;
        }
        file.close()?;
        Ok(())
    }

    fn schema(&self) -> Result<TypePtr, ParquetError> {
        let field = |name: &str, kind, repetition| {
            Type::primitive_type_builder(name, kind).with_repetition(repetition).build().map(Arc::new)
        };
        let mut fields = vec![
            field("stamp_ns", PhysicalType::INT64, Repetition::REQUIRED)?,
            field("time_s", PhysicalType::DOUBLE, Repetition::REQUIRED)?,
        ];
        for name in &self.names {
            fields.push(field(name, PhysicalType::DOUBLE, Repetition::OPTIONAL)?);
        }
        Type::group_type_builder("run").with_fields(fields).build().map(Arc::new)
    }
}

/// A column with nulls where cells are NaN.
fn optional<W: Write + Send>(
    group: &mut SerializedRowGroupWriter<'_, W>,
    cells: &[f64],
) -> Result<(), ParquetError> {
    let levels: Vec<i16> = cells.iter().map(|value| i16::from(value.is_finite())).collect();
    let values: Vec<f64> = cells.iter().copied().filter(|value| value.is_finite()).collect();
    let mut column =
        group.next_column()?.ok_or_else(|| ParquetError::General("no column to write".to_owned()))?;
    column.typed::<DoubleType>().write_batch(&values, Some(&levels), None)?;
    column.close()
}
