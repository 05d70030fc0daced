//! What `import` found: its JSON document.

use serde::{Deserialize, Serialize};

use crate::{document::PROGRAM, log::Understood, remark::Remarks};

/// How a CSV file was read.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Imported {
    /// Always "hydrotrace.import.v1".
    pub format: String,
    /// Name and version of the program that wrote it.
    pub program: String,
    /// Its form, clock and columns.
    pub understood: Understood,
    /// Doubts about the data.
    pub remarks: Remarks,
}

impl Imported {
    /// The document of an import.
    pub(super) fn new(understood: Understood, remarks: Remarks) -> Self {
        Self { format: "hydrotrace.import.v1".to_owned(), program: PROGRAM.to_owned(), understood, remarks }
    }
}
