//! `recover`: a sound log of all whole messages of a damaged one.

mod document;

use std::path::PathBuf;

pub use document::RecoverDocument;

use crate::log::{LogError, Recovered, recover};

/// Input and output of a recovery.
#[derive(Debug, Clone)]
pub struct Inputs {
    /// The damaged log.
    pub log: PathBuf,
    /// The log to write; it appears whole or not at all.
    pub output: PathBuf,
}

/// Recovers a log.
///
/// # Errors
///
/// [`LogError`] if the log cannot be read at all or the new one not written.
pub fn run(inputs: &Inputs) -> Result<Recovered, LogError> {
    recover(&inputs.log, &inputs.output)
}
