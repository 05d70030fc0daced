//! The JSON document of `join`.

use serde::{Deserialize, Serialize};

use super::Joined;
use crate::{document::PROGRAM, remark::Remark};

/// Where the plan was sent, and what the new log holds. Times are seconds since the start of the
/// run's log.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct JoinDocument {
    /// Always "hydrotrace.join.v1".
    pub format: String,
    /// Name and version of the program that wrote it.
    pub program: String,
    /// Topic and field of what was sent; null if the caller gave the time.
    pub sent: Option<String>,
    /// Whether the command was sent, and not the plan itself.
    pub sent_is_command: bool,
    /// When the first sample of the plan was sent, s.
    pub at_s: f64,
    /// Root mean square difference between what was sent and what was made, rad; null if the caller
    /// gave the time.
    pub rms_difference_rad: Option<f64>,
    /// Other places that fit as well; null if the caller gave the time.
    pub other_places: Option<usize>,
    /// From the first to the last sample of the plan, s.
    pub duration_s: f64,
    /// Rest added before the plan, s.
    pub rest_before_s: f64,
    /// Rest added after the plan, s.
    pub rest_after_s: f64,
    /// Number of joints of the plan.
    pub joints: usize,
    /// Messages of the run that were copied.
    pub messages: u64,
    /// Names of the files that came with the plan.
    pub files: Vec<String>,
    /// Doubts about the data.
    pub remarks: Vec<Remark>,
}

impl JoinDocument {
    /// The document of a join.
    pub fn of(joined: &Joined) -> Self {
        Self {
            format: "hydrotrace.join.v1".to_owned(),
            program: PROGRAM.to_owned(),
            sent: joined.sent.clone(),
            sent_is_command: joined.commanded,
            at_s: joined.at_s,
            rms_difference_rad: joined.located.map(|found| found.rms_rad),
            other_places: joined.located.map(|found| found.others),
            duration_s: joined.duration_s,
            rest_before_s: joined.rest_s[0],
            rest_after_s: joined.rest_s[1],
            joints: joined.joints,
            messages: joined.messages,
            files: joined.files.clone(),
            remarks: joined.remarks.as_slice().to_vec(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{remark::Remarks, schema::is_written_and_read};

    #[test]
    fn the_committed_schema_is_that_of_the_document_and_what_is_written_is_read_back() {
        let joined = Joined {
            sent: Some("/sent:positions".into()),
            commanded: true,
            located: None,
            at_s: 1.5,
            duration_s: 20.0,
            rest_s: [1.0, 3.0],
            joints: 4,
            messages: 1000,
            files: vec!["task.toml".into()],
            remarks: Remarks::default(),
        };
        let document = JoinDocument::of(&joined);
        is_written_and_read(&document, "join.v1.schema.json", "hydrotrace join, version 1");
    }
}
