//! What `record` wrote: its JSON document.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::Progress;
use crate::{document::PROGRAM, log::Understood, remark::Remarks};

/// What the format is called.
const FORMAT: &str = "hydrotrace.record.v1";

/// What came, and what became of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Recorded {
    /// Always "hydrotrace.record.v1".
    pub format: String,
    /// Name and version of the program that wrote it.
    pub program: String,
    /// The log, or its parts in order.
    pub logs: Vec<PathBuf>,
    /// Lines that came, a header among them.
    pub lines: u64,
    /// Rows that became samples.
    pub rows: u64,
    /// Joints, in the order of the log.
    pub joints: Vec<String>,
    /// Columns in use: number from 1, header, what it became, joint, unit.
    pub columns: Vec<String>,
    /// Doubts about the data.
    pub remarks: Remarks,
}

impl Recorded {
    pub(super) fn new(logs: &[PathBuf], progress: &Progress, read: &Understood, remarks: Remarks) -> Self {
        let columns = read.columns.iter().map(|one| {
            let unit = one.unit.as_deref().unwrap_or("as it came");
            format!("{}: {} of {}, {unit}", one.header, one.becomes, one.joint)
        });
        Self {
            format: FORMAT.to_owned(),
            program: PROGRAM.to_owned(),
            logs: logs.to_vec(),
            lines: progress.lines,
            rows: progress.rows,
            joints: read.joints.clone(),
            columns: columns.collect(),
            remarks,
        }
    }
}
