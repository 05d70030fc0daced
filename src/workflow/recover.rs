//! `recover`: its JSON document; [`crate::log::recover`] does it.

use serde::{Deserialize, Serialize};

use crate::{document::PROGRAM, log::Recovered};

/// How much of a damaged log was recovered.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct RecoverDocument {
    /// Always "hydrotrace.recover.v1".
    pub format: String,
    /// Name and version of the program that wrote it.
    pub program: String,
    /// What is in the new log.
    #[serde(flatten)]
    pub recovered: Recovered,
}

impl RecoverDocument {
    /// The document of a recovery.
    pub fn of(recovered: Recovered) -> Self {
        Self { format: "hydrotrace.recover.v1".to_owned(), program: PROGRAM.to_owned(), recovered }
    }
}
