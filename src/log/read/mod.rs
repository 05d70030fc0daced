//! Reading: from the files of a run to plan, measurement and other signals.

mod alike;
mod assemble;
mod beside;
mod by_words;
mod candidates;
mod choice;
mod content;
mod cylinders;
mod description;
mod extract;
mod followed;
mod frames;
mod held;
mod indexed;
mod joints;
mod jumps;
pub(super) mod lines;
mod lost;
pub(super) mod origin;
mod other_time;
mod overlap;
mod parallel;
mod poses;
mod prefixed;
mod quality;
pub(super) mod recording;
mod repeated;
mod samples;
mod scaled;
mod select_topics;
mod sender;
mod spoilt;
mod stopped;
mod time_base;
mod topics;
mod trajectories;
mod turns;
mod unlike;
mod unmeasured;
mod unset;
mod window;

use std::path::{Path, PathBuf};

use super::{
    error::LogError,
    files::{LogFiles, ScannedFile, ScannedLog},
    options::{ReadOptions, Sides},
    recovered,
};
use crate::{
    arm::continuous_joints,
    remark::{Code, Remarks},
    units::NS_PER_S,
};
use {
    assemble::assemble,
    content::Extracted,
    cylinders::Kinds,
    extract::extract,
    lines::{Descriptions, Lines},
    origin::Origin,
    recording::{Recording, Survey},
    select_topics::choose,
    topics::topic_infos,
};

/// Reads the files of one run (a bag directory counts as its files) in one pass.
///
/// # Errors
///
/// [`LogError`] if a file is no log, or something that the options require is not found in it.
///
/// ```
/// use hydrotrace::log::{ReadOptions, read_recording};
///
/// let run = read_recording(&["sample-logs/panel-install.mcap".into()], &ReadOptions::default())?;
/// let boom = &run.measured.tracks[0];
/// assert_eq!((boom.name(), boom.kind().unit()), ("joint_1", "rad"));
/// assert!(boom.t_s().windows(2).all(|pair| pair[0] < pair[1]));
/// # Ok::<(), hydrotrace::log::LogError>(())
/// ```
pub fn read_recording(paths: &[PathBuf], options: &ReadOptions) -> Result<Recording, LogError> {
    let files = LogFiles::with(paths.iter().cloned(), options)?;
    files.scan()?.read(options)
}

/// As [`read_recording`] with [`Sides::Plan`].
///
/// # Errors
///
/// [`LogError`] if a file is no log, or no planned joints are found in it.
pub fn read_plan(paths: &[PathBuf], options: &ReadOptions) -> Result<Recording, LogError> {
    read_recording(paths, &ReadOptions { sides: Sides::Plan, ..options.clone() })
}

/// Lists what is in a log and what a report would use.
///
/// # Errors
///
/// [`LogError`] if a file cannot be opened or is no log.
pub fn survey(paths: &[PathBuf], options: &ReadOptions) -> Result<Survey, LogError> {
    LogFiles::with(paths.iter().cloned(), options)?.survey(options)
}

/// As [`survey`] of one file in memory, for fuzzing.
///
/// # Errors
///
/// [`LogError`] if the bytes are no log.
#[doc(hidden)]
pub fn survey_bytes(bytes: &[u8], options: &ReadOptions) -> Result<Survey, LogError> {
    let source = bytes.to_vec().into();
    let files = ScannedFile::all(Path::new("memory.mcap"), &source)?;
    let log = ScannedLog { files, ordered: true, described: false, remarks: Remarks::default() };
    Ok(log.survey(options))
}

impl LogFiles {
    /// Lists what is in the files and what a report would use; reads all of it.
    ///
    /// # Errors
    ///
    /// [`LogError::NotMcap`].
    pub fn survey(&self, options: &ReadOptions) -> Result<Survey, LogError> {
        Ok(self.scan()?.survey(options))
    }

    /// Where the numbers of the joints lie in the messages, and what a report would use; reads all of it.
    ///
    /// # Errors
    ///
    /// [`LogError`] if a file is no log, or nothing in it can be drawn.
    pub fn lines(&self, options: &ReadOptions) -> Result<Lines, LogError> {
        let log = self.scan()?;
        let known = Descriptions::of(&log);
        let extracted = extract(&log, &lines::wanting_all(options, &known));
        let mut lines = lines::of(&extracted, &known, options)?;
        lines.recording = recording(extracted, options);
        Ok(lines)
    }
}

impl ScannedLog<'_> {
    /// Reads what the options say, in one pass.
    ///
    /// # Errors
    ///
    /// [`LogError`] if something that the options require is not found.
    pub fn read(&self, options: &ReadOptions) -> Result<Recording, LogError> {
        let extracted = extract(self, options);
        let description = description::of(&extracted);
        recording(extracted, options).or_else(|error| by_words::recording(self, options, description, error))
    }

    fn survey(&self, options: &ReadOptions) -> Survey {
        let extracted = extract(self, options);
        let topics = topic_infos(&extracted);
        let files = extracted.files.clone();
        let attachments = extracted.attachments.iter().map(|a| a.name.clone()).collect();
        let remarks = extracted.remarks.clone();
        let times = || extracted.topics.iter().filter(|topic| topic.messages > 0);
        let begins_ns = times().map(|topic| topic.first_log_ns).min().unwrap_or(0);
        let ends_ns = times().map(|topic| topic.last_log_ns).max().unwrap_or(0);
        let duration_s = ends_ns.saturating_sub(begins_ns) as f64 / NS_PER_S;
        let description = description::of(&extracted);
        let recording = recording(extracted, options)
            .or_else(|error| by_words::recording(self, options, description, error));
        let remarks = recording.as_ref().map_or(remarks, |r| r.remarks.clone());
        Survey { files, topics, attachments, duration_s, recording, remarks }
    }
}

fn recording(extracted: Extracted, options: &ReadOptions) -> Result<Recording, LogError> {
    let path = extracted.path.clone();
    let damage: Vec<String> = extracted
        .remarks
        .as_slice()
        .iter()
        .filter(|remark| {
            matches!(
                remark.code,
                Code::DamagedBytes | Code::DamagedChunk | Code::PartialChunk | Code::NotClosed
            )
        })
        .map(|remark| remark.message.clone())
        .collect();
    assembled(extracted, options).map_err(|error| {
        if damage.is_empty() || !error.is_of_something_not_found() {
            return error;
        }
        LogError::Damaged { error: Box::new(error), damage: damage.join("; "), path }
    })
}

fn assembled(mut extracted: Extracted, options: &ReadOptions) -> Result<Recording, LogError> {
    let mut options = options.clone();
    options.description = options.description.or_else(|| description::of(&extracted));
    let told = options.continuous.clone();
    options.continuous.extend(options.description.as_deref().map(continuous_joints).unwrap_or_default());
    let mut kinds = Kinds::of_names(&mut extracted, &mut options)?;
    let choice = match choose(&extracted, &options) {
        Err(LogError::NoCommonJoint { .. }) if prefixed::pair(&mut extracted, &mut options, &mut kinds)? => {
            choose(&extracted, &options)?
        }
        choice => choice?,
    };
    let options = &options;
    for topic in topic_infos(&extracted) {
        ::log::debug!(
            "topic {} ({}): {} messages, joint positions in {:?}",
            topic.topic,
            topic.type_name,
            topic.messages,
            topic.joint_fields
        );
    }
    let tables = extracted.tables.clone();
    let mut recording = assemble(extracted, &choice, options, kinds)?;
    let here = |name: &String| {
        [&recording.planned, &recording.measured].iter().any(|side| side.track(name).is_some())
    };
    // Of names that were paired by their last part the caller may have said either.
    let unknown =
        told.iter().filter(|name| !here(name) && !options.continuous[told.len()..].iter().any(here));
    let unknown: Vec<String> = unknown.cloned().collect();
    for name in unknown {
        let message = format!("joint {name} that --continuous names is not among those read");
        recording.remarks.add(Code::UnpairedJoint, 1, message);
    }
    let Recording { planned, measured, metadata, source, remarks, .. } = &mut recording;
    recovered::remark(metadata, remarks);
    let topics = [&source.planned_topic, &source.measured_topic];
    source.origin = Origin::of(&tables, topics, [planned, measured]);
    ::log::info!("planned {}:{}", source.planned_topic, source.planned_field);
    ::log::info!("measured {}:{}", source.measured_topic, source.measured_field);
    ::log::info!("chosen: {}", source.why);
    ::log::info!("clock {}: {}", source.time_base.name(), source.time_base_why);
    Ok(recording)
}
