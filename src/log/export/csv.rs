//! The table as comma-separated values.

use std::io::Write;

use super::{ExportError, RunTable};
use crate::text::spreadsheet_cell;

impl RunTable {
    /// Writes comma-separated values with a header; a cell without a sample is empty. Numbers have
    /// as many digits as give the same number back.
    ///
    /// # Errors
    ///
    /// [`ExportError::Output`]
    pub fn write_csv<W: Write>(&self, output: W) -> Result<(), ExportError> {
        let mut writer = ::csv::Writer::from_writer(output);
        let failed = |error: ::csv::Error| match error.into_kind() {
            ::csv::ErrorKind::Io(error) => ExportError::Output(error),
            other => ExportError::Output(std::io::Error::other(format!("{other:?}"))),
        };
        writer
            .write_record(self.column_names().map(|name| spreadsheet_cell(name).into_owned()))
            .map_err(failed)?;
        let mut cell = String::new();
        for (row, (stamp_ns, time_s)) in self.stamp_ns.iter().zip(&self.time_s).enumerate() {
            let mut write = |text: std::fmt::Arguments<'_>| {
                cell.clear();
                // Writing to memory does not fail.
                let _ = std::fmt::Write::write_fmt(&mut cell, text);
                writer.write_field(&cell)
            };
            write(format_args!("{stamp_ns}")).map_err(failed)?;
            write(format_args!("{time_s}")).map_err(failed)?;
            for column in &self.cells {
                match column.get(row).filter(|value| value.is_finite()) {
                    Some(value) => write(format_args!("{value}")).map_err(failed)?,
                    None => write(format_args!("")).map_err(failed)?,
                }
            }
            writer.write_record(None::<&[u8]>).map_err(failed)?;
        }
        Ok(writer.flush()?)
    }
}
