//! The JSON document of `recover`.

use serde::{Deserialize, Serialize};

use crate::{document::PROGRAM, log::Recovered, remark::Remark};

/// How much of a damaged log was recovered.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct RecoverDocument {
    /// Always "hydrotrace.recover.v1".
    pub format: String,
    /// Name and version of the program that wrote it.
    pub program: String,
    /// Messages in the new log.
    pub messages: u64,
    /// Of these, from chunks that are not as they were written: some may be wrong.
    #[serde(default)]
    pub doubtful_messages: u64,
    /// Chunks, or runs of messages outside chunks, that were read.
    pub blocks: usize,
    /// Blocks that could not be read at all.
    pub dropped_blocks: u64,
    /// Attachments in the new log.
    pub attachments: usize,
    /// Losses and doubts; empty if there are none.
    pub remarks: Vec<Remark>,
}

impl RecoverDocument {
    /// The document of a recovery.
    pub fn of(recovered: &Recovered) -> Self {
        let Recovered { messages, doubtful, blocks, dropped_blocks, attachments, remarks } = recovered;
        Self {
            format: "hydrotrace.recover.v1".to_owned(),
            program: PROGRAM.to_owned(),
            messages: *messages,
            doubtful_messages: *doubtful,
            blocks: *blocks,
            dropped_blocks: *dropped_blocks,
            attachments: *attachments,
            remarks: remarks.as_slice().to_vec(),
        }
    }
}
