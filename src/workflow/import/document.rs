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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        log::{CsvOptions, read_csv_bytes},
        schema::is_written_and_read,
    };

    #[test]
    fn the_committed_schema_is_that_of_the_document_and_what_is_written_is_read_back() {
        let table = b"time_s,J1_planned_rad,J1_measured_rad\n0,0.1,0.1\n0.01,0.2,0.1\n0.02,0.3,0.2\n";
        let run = read_csv_bytes("a.csv", table, &CsvOptions::default()).unwrap();
        let document = Imported::new(run.understood, run.remarks);
        assert_eq!(document.understood.joints, ["J1"]);
        is_written_and_read(&document, "import.v1.schema.json", "hydrotrace import, version 1");
    }
}
