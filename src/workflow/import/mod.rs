//! `import`: a CSV file becomes a log.

mod document;

use std::{
    io::Write,
    path::{Path, PathBuf},
};

use thiserror::Error;

pub use document::Imported;

use crate::{
    atomic_file::{AtomicError, write_atomically},
    log::{Contents, CsvError, CsvOptions, LogError, WriteError, contents, read_csv, read_messages},
};

/// Input, options and output of an import.
#[derive(Debug, Clone, Default)]
pub struct Inputs {
    /// The CSV file.
    pub file: PathBuf,
    /// What the caller says of it.
    pub options: CsvOptions,
    /// The log to write; it appears whole or not at all.
    pub output: PathBuf,
    /// Where to write how the columns were read, to read the next file alike.
    pub map: Option<PathBuf>,
}

/// Why there is no log.
#[derive(Debug, Error)]
pub enum ImportError {
    /// The file is not understood.
    #[error(transparent)]
    Csv(#[from] CsvError),
    /// The bag or log is not read.
    #[error(transparent)]
    Log(#[from] LogError),
    /// The log cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// The map takes no more.
    #[error("cannot write the map")]
    Map(#[source] std::io::Error),
    /// The log cannot be put in place.
    #[error(transparent)]
    Atomic(#[from] AtomicError),
}

/// Whether a path is that of a log or of a bag, whose messages are a table.
fn is_recording(path: &Path) -> bool {
    path.is_dir() || matches!(contents(path), Ok(Contents::Log { .. } | Contents::Recording(_)))
}

/// Imports a table, or the messages of a bag by the words of their fields.
///
/// # Errors
///
/// [`ImportError`]; then there is no output.
pub fn run(inputs: &Inputs) -> Result<Imported, ImportError> {
    let run = if is_recording(&inputs.file) {
        read_messages(&inputs.file, &inputs.options).map_err(|error| match error {
            LogError::Table { source, .. } => ImportError::Csv(*source),
            other => other.into(),
        })?
    } else {
        read_csv(&inputs.file, &inputs.options)?
    };
    write_atomically(&inputs.output, |file| run.write(file).map(|_| ()).map_err(ImportError::from))?;
    if let Some(path) = &inputs.map {
        let text = inputs.options.to_map(&run.understood);
        write_atomically(path, |file| file.write_all(text.as_bytes()).map_err(ImportError::Map))?;
    }
    Ok(Imported::new(run.understood, run.remarks))
}
