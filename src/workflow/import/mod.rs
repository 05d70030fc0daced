//! `import`: a CSV file becomes a log.

mod document;

use std::{io::Write, path::PathBuf};

use thiserror::Error;

pub use document::Imported;

use crate::{
    atomic_file::{AtomicError, write_atomically},
    log::{CsvError, CsvOptions, WriteError, read_csv},
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

/// Imports a CSV file.
///
/// # Errors
///
/// [`ImportError`]; then there is no output.
pub fn run(inputs: &Inputs) -> Result<Imported, ImportError> {
    let run = read_csv(&inputs.file, &inputs.options)?;
    write_atomically(&inputs.output, |file| run.write(file).map(|_| ()).map_err(ImportError::from))?;
    if let Some(path) = &inputs.map {
        let text = inputs.options.to_map(&run.understood);
        write_atomically(path, |file| file.write_all(text.as_bytes()).map_err(ImportError::Map))?;
    }
    Ok(Imported::new(run.understood, run.remarks))
}
