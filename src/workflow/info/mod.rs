//! `info`: what is in a log, what a report would use, and how healthy it is.

mod document;

use std::path::PathBuf;

pub use document::InfoDocument;

use crate::log::{LogError, ReadOptions, Survey, survey};

/// What to look at.
#[derive(Debug, Clone, Default)]
pub struct Inputs {
    /// Files or bag directories of one run.
    pub logs: Vec<PathBuf>,
    /// What to read, where the log alone does not tell.
    pub read: ReadOptions,
}

/// Looks at a log.
///
/// # Errors
///
/// [`LogError`] if a file cannot be opened or is no log; that no report can be made of it is
/// part of the result.
pub fn run(inputs: &Inputs) -> Result<Survey, LogError> {
    survey(&inputs.logs, &inputs.read)
}
