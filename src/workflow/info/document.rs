//! The JSON document of `info`.

use serde::{Deserialize, Serialize};

use crate::{
    document::PROGRAM,
    log::{FileInfo, SourceInfo, Survey, TopicInfo},
    remark::Remark,
};

/// What is in a log, and what a report would use. Times are seconds since the first sample.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct InfoDocument {
    /// Always "hydrotrace.info.v1".
    pub format: String,
    /// Name and version of the program that wrote it.
    pub program: String,
    /// The files of the run, in order.
    pub files: Vec<FileInfo>,
    /// All topics, by name.
    pub topics: Vec<TopicInfo>,
    /// From the first message to the last, by the recorder's clock, s.
    #[serde(default)]
    pub duration_s: f64,
    /// Whether every message was read; else only the index was, and damage, joints and what a report would use are not known.
    #[serde(default)]
    pub checked: bool,
    /// Names of the files stored in the log.
    pub attachments: Vec<String>,
    /// Where a report would take its data from; null if no report can be made.
    pub source: Option<SourceInfo>,
    /// Why no report can be made; null if one can.
    pub no_report_because: Option<String>,
    /// The joints that a report would cover.
    pub joints: Vec<String>,
    /// Doubts about the data.
    pub remarks: Vec<Remark>,
}

impl InfoDocument {
    /// The document of a survey.
    pub fn of(survey: &Survey) -> Self {
        let Survey { files, topics, attachments, duration_s, recording, remarks } = survey;
        Self {
            format: "hydrotrace.info.v1".to_owned(),
            program: PROGRAM.to_owned(),
            files: files.clone(),
            topics: topics.clone(),
            duration_s: *duration_s,
            checked: survey.is_checked(),
            attachments: attachments.clone(),
            source: recording.as_ref().ok().map(|r| r.source.clone()),
            no_report_because: recording.as_ref().err().map(ToString::to_string),
            joints: survey.joints().map(str::to_owned).collect(),
            remarks: remarks.as_slice().to_vec(),
        }
    }
}
