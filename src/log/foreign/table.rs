//! Tables as logs.

use std::path::Path;

use crate::{
    log::{
        csv::{CsvError, CsvOptions, read_csv_bytes},
        error::LogError,
        file::Source,
        import_line::Given,
    },
    remark::Remarks,
};

/// The log that a table becomes by the file itself and what is said of its columns.
pub(super) fn log(
    path: &Path,
    text: &[u8],
    columns: &CsvOptions,
    remarks: &mut Remarks,
) -> Result<Source, LogError> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let fault = |source: CsvError| LogError::Table {
        path: path.to_owned(),
        source: Box::new(source.at(path)),
        given: Given::default(),
    };
    let run = read_csv_bytes(&name, text, columns).map_err(fault)?;
    remarks.extend(run.remarks.clone());
    Ok(run.write(Vec::new()).map_err(|error| fault(error.into()))?.into())
}
