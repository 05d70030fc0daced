//! From the files of a run to planned and measured series, and what was chosen on the way.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

use serde::{Deserialize, Serialize};

use super::{
    Attachment, FileInfo, LogError, Selector,
    assemble::assemble,
    read::{Extracted, extract, extract_bytes},
    select_topics::{Choice, choose, choose_measured, choose_plan, topic_infos},
    source,
};
use crate::{remark::Remarks, series::Series};

/// What to read, where the log alone does not tell or is not to be asked.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct ReadOptions {
    /// Topics of the plan; empty: found by type and name.
    pub planned: Vec<Selector>,
    /// Topics of the measurement; empty: found by type and name.
    pub measured: Vec<Selector>,
    /// Joints to read, and names for topics that carry none; empty: all.
    pub joints: Vec<String>,
    /// Which clock to use; `None`: the header's where it is usable.
    pub time_base: Option<TimeBase>,
    /// The plan is in degrees.
    pub planned_in_degrees: bool,
    /// What is read as the plan is another quantity, such as a pressure: any number may be.
    pub planned_is_no_angle: bool,
    /// The measurement is in degrees.
    pub measured_in_degrees: bool,
    /// Joints without end stops, whose angle may wrap by a full turn.
    pub continuous: Vec<String>,
}

/// Which clock the times of a run come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum TimeBase {
    /// The stamp in the message: when the sample was taken.
    Header,
    /// When the message was published.
    Publish,
    /// When the recorder received it.
    Log,
}

impl TimeBase {
    /// The word for it on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Header => "header",
            Self::Publish => "publish",
            Self::Log => "log",
        }
    }
}

/// Where the series come from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct SourceInfo {
    /// Topic and field of the plan; several are joined by a comma.
    pub planned_topic: String,
    /// Field of the plan within its messages.
    pub planned_field: String,
    /// Topic of the measurement.
    pub measured_topic: String,
    /// Field of the measurement within its messages.
    pub measured_field: String,
    /// Why these.
    pub why: String,
    /// The clock.
    pub time_base: TimeBase,
    /// Why this clock.
    pub time_base_why: String,
    /// Messages of the measured topic.
    pub messages: u64,
    /// The instant that times count from, ns since 1970.
    pub epoch_ns: i64,
    /// From the first to the last sample, s.
    pub duration_s: f64,
    /// Median and largest delay from the header's stamp to the recorder, s, where both exist.
    pub recorder_delay_s: Option<[f64; 2]>,
}

/// A topic of the log.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TopicInfo {
    /// Its name.
    pub topic: String,
    /// Message type.
    pub type_name: String,
    /// Message encoding.
    pub encoding: String,
    /// Messages found.
    pub messages: u64,
    /// Mean rate over its own duration, Hz; 0 for a single message.
    pub rate_hz: f64,
    /// Fields that hold joint angles, for `--planned` and `--measured`.
    pub joint_fields: Vec<String>,
    /// Joints named in it.
    pub joints: Vec<String>,
}

/// A run as read from its log.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    /// The plan.
    pub planned: Series,
    /// The measurement.
    pub measured: Series,
    /// Whether the plan is what was sent, for want of another.
    pub plan_is_command: bool,
    /// Where both come from.
    pub source: SourceInfo,
    /// What was doubtful.
    pub remarks: Remarks,
    /// Files stored in the log.
    pub attachments: Vec<Attachment>,
    /// Named maps of texts stored in the log.
    pub metadata: BTreeMap<String, BTreeMap<String, String>>,
}

/// What is in a log, whether or not a report can be made of it.
#[derive(Debug)]
pub struct Survey {
    /// Its files.
    pub files: Vec<FileInfo>,
    /// Its topics, by name.
    pub topics: Vec<TopicInfo>,
    /// Names of the files stored in it.
    pub attachments: Vec<String>,
    /// What a report would use, or why it would not.
    pub recording: Result<Recording, LogError>,
    /// What was doubtful about the files.
    pub remarks: Remarks,
}

fn selectors(options: &ReadOptions) -> Vec<(source::Role, Selector)> {
    let of = |role, list: &[Selector]| list.iter().map(move |s| (role, s.clone())).collect::<Vec<_>>();
    [of(source::Role::Planned, &options.planned), of(source::Role::Measured, &options.measured)].concat()
}

/// Reads planned and measured joints from the files of one run (a bag directory counts as its
/// files).
///
/// # Errors
///
/// [`LogError`] if a file is no log, or no planned and measured joints are found in it.
pub fn read_recording(paths: &[PathBuf], options: &ReadOptions) -> Result<Recording, LogError> {
    let extracted = extract(paths, &selectors(options), &options.joints)?;
    recording(extracted, options)
}

/// Reads planned joints alone, of a log that need not hold a measurement; that is then empty. With
/// [`ReadOptions::planned`] it reads any topic as if it were a plan, such as a command.
///
/// # Errors
///
/// [`LogError`] if a file is no log, or no planned joints are found in it.
pub fn read_plan(paths: &[PathBuf], options: &ReadOptions) -> Result<Recording, LogError> {
    let mut extracted = extract(paths, &selectors(options), &options.joints)?;
    let doubts = std::mem::take(&mut extracted.remarks);
    let choice = choose_plan(&extracted, options)?;
    let recording = assemble(extracted, &choice, options)?;
    // That nothing was measured is no doubt here.
    Ok(Recording { remarks: doubts, ..recording })
}

/// Reads measured joints alone, of a log that need not hold a plan; that is then empty.
///
/// # Errors
///
/// [`LogError`] if a file is no log, or no measured joints are found in it.
pub fn read_measured(paths: &[PathBuf], options: &ReadOptions) -> Result<Recording, LogError> {
    let mut extracted = extract(paths, &selectors(options), &options.joints)?;
    let doubts = std::mem::take(&mut extracted.remarks);
    let choice = choose_measured(&extracted, options)?;
    let recording = assemble(extracted, &choice, options)?;
    // That nothing was planned is no doubt here.
    Ok(Recording { remarks: doubts, ..recording })
}

/// Lists what is in a log and what a report would use.
///
/// # Errors
///
/// [`LogError`] if a file cannot be opened or is no log.
pub fn survey(paths: &[PathBuf], options: &ReadOptions) -> Result<Survey, LogError> {
    Ok(survey_of(extract(paths, &selectors(options), &options.joints)?, options))
}

/// As [`survey`] of one file in memory, for fuzzing.
///
/// # Errors
///
/// [`LogError`] if the bytes are no log.
#[doc(hidden)]
pub fn survey_bytes(bytes: &[u8], options: &ReadOptions) -> Result<Survey, LogError> {
    let files = [(Path::new("memory.mcap"), bytes)];
    Ok(survey_of(
        extract_bytes(&files, true, &selectors(options), &options.joints, Remarks::default())?,
        options,
    ))
}

fn survey_of(extracted: Extracted, options: &ReadOptions) -> Survey {
    let topics = topic_infos(&extracted);
    let files = extracted.files.clone();
    let attachments = extracted.attachments.iter().map(|a| a.name.clone()).collect();
    let remarks = extracted.remarks.clone();
    let recording = recording(extracted, options);
    let remarks = recording.as_ref().map_or(remarks, |r| r.remarks.clone());
    Survey { files, topics, attachments, recording, remarks }
}

fn recording(extracted: Extracted, options: &ReadOptions) -> Result<Recording, LogError> {
    let choice: Choice = choose(&extracted, options)?;
    for topic in topic_infos(&extracted) {
        ::log::debug!(
            "topic {} ({}): {} messages, joint angles in {:?}",
            topic.topic,
            topic.type_name,
            topic.messages,
            topic.joint_fields
        );
    }
    let recording = assemble(extracted, &choice, options)?;
    let source = &recording.source;
    ::log::info!("planned {}:{}", source.planned_topic, source.planned_field);
    ::log::info!("measured {}:{}", source.measured_topic, source.measured_field);
    ::log::info!("chosen: {}", source.why);
    ::log::info!("clock {}: {}", source.time_base.name(), source.time_base_why);
    Ok(recording)
}
