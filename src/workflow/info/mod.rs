//! `info`: the content of a log, the topics that a report would use, and its damage.

mod document;

use std::path::PathBuf;

pub use document::InfoDocument;

use crate::log::{LogError, LogFiles, ReadOptions, Survey};

/// Logs up to this size are read whole, which takes a tenth of a second, bytes.
const READ_WHOLE: u64 = 64 << 20;

/// Input of a survey.
#[derive(Debug, Clone, Default)]
pub struct Inputs {
    /// Files or bag directories of one run.
    pub logs: Vec<PathBuf>,
    /// Topics, joints, clock and units, where the log alone does not determine them.
    pub read: ReadOptions,
    /// Whether every message is read, whatever the size of the log.
    pub check: bool,
}

/// Looks at a log: at all of it, or, of a large one that is closed, at its index.
///
/// # Errors
///
/// [`LogError`] if a file cannot be opened or is no log; that no report can be made of it is
/// part of the result.
pub fn run(inputs: &Inputs) -> Result<Survey, LogError> {
    let files = LogFiles::with(inputs.logs.iter().cloned(), &inputs.read)?;
    // What a reader of options asks for is found by reading.
    let by_index = !inputs.check && inputs.read == ReadOptions::default() && files.bytes() > READ_WHOLE;
    match by_index.then(|| files.survey_by_index()).flatten() {
        Some(survey) => Ok(survey),
        None => files.survey(&inputs.read),
    }
}
