//! A recording as read from its log.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::origin::Origin;
use crate::{
    log::{
        csv::is_dated,
        error::LogError,
        options::{SignalRole, TimeBase},
    },
    remark::Remarks,
    series::{Pair, Series, Signal, Track, align},
};

/// A file of the recording.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct FileInfo {
    /// Its name without the path.
    pub name: String,
    /// Its size.
    pub bytes: u64,
    /// Chunks, or runs of messages outside chunks.
    pub blocks: usize,
    /// Whether the recorder ended it properly.
    pub closed: bool,
}

/// A file stored inside a log.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Attachment {
    /// Its name.
    pub name: String,
    /// Its media type.
    pub media_type: String,
    /// Its content; empty if it is longer than 64 MiB.
    pub data: Vec<u8>,
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
    /// The same by its clock as that was set on the way, where it began without a date.
    #[serde(skip)]
    pub epoch_set_ns: Option<i64>,
    /// From the first to the last sample, s.
    pub duration_s: f64,
    /// Median and largest delay from the header's stamp to the recorder, s, where both exist.
    pub recorder_delay_s: Option<[f64; 2]>,
    /// What an imported log was read from.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub origin: Option<Origin>,
    /// What the caller had taken off the measurement's stamps, s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub measured_delay_s: Option<f64>,
}

impl SourceInfo {
    /// When the run began, ns since 1970; `None` where its stamps say no date.
    pub fn began_ns(&self) -> Option<i64> {
        let undated = self.origin.as_ref().is_some_and(|origin| origin.undated);
        let dated = |epoch_ns: &i64| !undated && is_dated(*epoch_ns);
        Some(self.epoch_ns).filter(dated).or(self.epoch_set_ns.filter(dated))
    }

    /// The instant `epoch_ns` by a clock that was set by one of these jumps, if it says no date and that does.
    pub(super) fn epoch_set_ns(epoch_ns: i64, jumps_ns: &[i64]) -> Option<i64> {
        let set = |jump_ns: &i64| Some(epoch_ns.saturating_sub(*jump_ns)).filter(|ns| is_dated(*ns));
        jumps_ns.iter().find_map(set).filter(|_| !is_dated(epoch_ns))
    }
}

/// A topic of the log.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
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
    /// Fields that hold joint positions, for `--planned` and `--measured`.
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
    /// The tool, where the log holds its planned and measured poses.
    pub poses: Option<ToolPoses>,
    /// Whether the plan is the command, because the log holds no other plan.
    pub plan_is_command: bool,
    /// The command, if it was wanted and is there.
    pub command: Option<Command>,
    /// The other signals that were wanted and are there, by joint.
    pub signals: BTreeMap<SignalRole, Vec<Signal>>,
    /// Where plan and measurement come from.
    pub source: SourceInfo,
    /// From when to when the machine stood though its plan went on, s, where the remarks say that it was stopped; the second is infinite
    /// where it did not go on.
    pub stood_s: Option<[f64; 2]>,
    /// Doubts about the data.
    pub remarks: Remarks,
    /// Files stored in the log.
    pub attachments: Vec<Attachment>,
    /// Named maps of texts stored in the log.
    pub metadata: BTreeMap<String, BTreeMap<String, String>>,
    /// The robot's URDF, as a message or a file of the log.
    pub description: Option<String>,
}

/// Planned and measured poses of a tool, on the clock of plan and measurement.
#[derive(Debug, Clone, PartialEq)]
pub struct ToolPoses {
    /// The plan.
    pub planned: Signal,
    /// The measurement.
    pub measured: Signal,
}

/// The positions that were sent to the controller.
#[derive(Debug, Clone, PartialEq)]
pub struct Command {
    /// Its topic.
    pub topic: String,
    /// By joint, on the clock of plan and measurement.
    pub series: Series,
}

impl Recording {
    /// A signal of a joint.
    pub fn signal(&self, role: SignalRole, joint: &str) -> Option<&Signal> {
        self.signals.get(&role)?.iter().find(|signal| signal.name() == joint)
    }

    /// Whether the log holds a signal.
    pub fn has(&self, role: SignalRole) -> bool {
        self.signals.contains_key(&role)
    }

    /// The measured joints beside their plan.
    pub(crate) fn pairs(&self) -> Vec<Pair> {
        let pair = |track: &Track| align(self.planned.track(track.name())?, track);
        self.measured.tracks.iter().filter_map(pair).collect()
    }

    /// A file stored in the log.
    pub fn attached(&self, name: &str) -> Option<&Attachment> {
        self.attachments.iter().find(|file| file.name == name)
    }
}

/// The content of a log, whether or not a report can be made of it.
#[derive(Debug)]
pub struct Survey {
    /// Its files.
    pub files: Vec<FileInfo>,
    /// Its topics, by name.
    pub topics: Vec<TopicInfo>,
    /// Names of the files stored in it.
    pub attachments: Vec<String>,
    /// From the first message to the last, by the recorder's clock, s.
    pub duration_s: f64,
    /// The recording that a report would use, or why no report can be made.
    pub recording: Result<Recording, LogError>,
    /// Doubts about the files.
    pub remarks: Remarks,
}

impl Survey {
    /// Whether the messages were read, not the index alone.
    pub fn is_checked(&self) -> bool {
        !matches!(self.recording, Err(LogError::NotLookedAt { .. }))
    }

    /// The joints that a report would cover.
    pub fn joints(&self) -> impl Iterator<Item = &str> {
        let both = |recording: &'_ Recording, name: &str| recording.measured.track(name).is_some();
        let recording = self.recording.iter();
        recording
            .flat_map(move |r| r.planned.tracks.iter().map(Track::name).filter(move |name| both(r, name)))
    }
}
