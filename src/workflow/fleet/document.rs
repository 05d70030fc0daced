//! What a scan did: its JSON document.

use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
};

use serde::{Deserialize, Serialize};

use super::tables::{Name, Rows};
use crate::{
    document::PROGRAM,
    log::dataset::Cell,
    remark::{Code, Remarks},
};

/// What the format is called.
const FORMAT: &str = "hydrotrace.fleet-scan.v1";

/// What a scan found and wrote.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Scanned {
    /// Always "hydrotrace.fleet-scan.v1".
    pub format: String,
    /// Name and version of the program that wrote it.
    pub program: String,
    /// The folder of the dataset.
    pub into: PathBuf,
    /// Logs found.
    pub logs: usize,
    /// Tables beside them, which were not asked for.
    #[serde(default)]
    pub tables_left: usize,
    /// Logs that the dataset held already, as they are.
    pub unchanged: usize,
    /// Logs that were analysed now.
    pub analysed: usize,
    /// Logs among these whose rows took the place of older ones.
    pub replaced: usize,
    /// Machines of the logs that were analysed now, by name.
    pub machines: Vec<String>,
    /// Rows of joints that were written.
    pub joints: usize,
    /// Rows of starts and reversals that were written.
    pub transitions: usize,
    /// Logs that could not be analysed, in the order of their paths.
    pub failures: Vec<Failure>,
    /// Doubts about the logs as a whole; those about single logs are in the table of remarks.
    pub remarks: Remarks,
}

/// A log that could not be analysed.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Failure {
    /// Its path.
    pub log: String,
    /// Why, with all reasons.
    pub error: String,
}

impl Scanned {
    pub(super) fn new(into: &Path, logs: usize) -> Self {
        Self {
            format: FORMAT.to_owned(),
            program: PROGRAM.to_owned(),
            into: into.to_owned(),
            logs,
            ..Self::default()
        }
    }

    /// Takes in what a batch gave.
    pub(super) fn add(&mut self, batch: &[Rows], failures: Vec<Option<Failure>>) {
        let mut machines: BTreeSet<String> = std::mem::take(&mut self.machines).into_iter().collect();
        for (rows, failure) in batch.iter().zip(&failures) {
            self.analysed += 1;
            let of = |name: Name| rows.iter().filter(|(table, _)| *table == name).count();
            self.joints += of(Name::Joints);
            self.transitions += of(Name::Transitions);
            let machine = rows.first().and_then(|(_, row)| row.get(1)).and_then(Cell::as_text);
            let message = "logs that name no machine; answers leave them out: give --machine-from";
            self.remarks.add(
                Code::UnknownMachine,
                u64::from(machine.is_none() && failure.is_none()),
                message,
            );
            machines.extend(machine.map(str::to_owned));
        }
        self.machines = machines.into_iter().collect();
        let failures = failures.into_iter().flatten();
        let message = "logs that could not be analysed; each has a row with its error";
        self.failures.extend(failures.inspect(|_| self.remarks.add(Code::UnreadableLog, 1, message)));
    }
}
