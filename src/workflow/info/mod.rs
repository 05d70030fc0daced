//! `info`: the content of a log, the topics that a report would use, and its damage.

mod document;

use std::path::PathBuf;

pub use document::InfoDocument;

use crate::log::{LogError, ReadOptions, Survey, survey};

/// Input of a survey.
#[derive(Debug, Clone, Default)]
pub struct Inputs {
    /// Files or bag directories of one run.
    pub logs: Vec<PathBuf>,
    /// Topics, joints, clock and units, where the log alone does not determine them.
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
