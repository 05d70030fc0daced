//! A log with a plan put into it.

use std::{
    collections::BTreeMap,
    io::Write,
    iter::Peekable,
    path::{Path, PathBuf},
    slice::Iter,
};

use super::{
    Attachment, LogError, LogWriter, Role, Topics, WriteError, WriteOptions, bag,
    copy::{Copier, Failure, copy_files},
    file::{Blocks, Layout, MappedFile, MessageRecord, Opcode, records, scan},
    read::not_mcap,
};
use crate::{
    atomic_file::{AtomicError, write_atomically},
    remark::Remarks,
};

/// One instant of a plan, by joint: angle, rad, and speed, rad/s.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PlanSample {
    /// Header stamp, ns since 1970.
    pub stamp_ns: i64,
    /// Where the joints should be.
    pub planned: [Vec<f64>; 2],
    /// What was sent.
    pub command: [Vec<f64>; 2],
}

/// What to put into a log.
#[derive(Debug, Clone, PartialEq)]
pub struct Addition<'a> {
    /// The joints of the samples.
    pub joints: Vec<&'a str>,
    /// The plan, ascending in time.
    pub samples: Vec<PlanSample>,
    /// How much later than their stamps the log's messages were received, ns.
    pub log_delay_ns: i64,
    /// Files, in place of those of their names.
    pub files: &'a [Attachment],
    /// Name and entries of metadata, in place of those of this name.
    pub metadata: (&'a str, BTreeMap<String, String>),
}

/// Writes all messages, files and metadata of a run's logs to `output`, and the plan among them; what was
/// sent too, where the logs do not have its topic. Returns the number of messages that were copied.
///
/// # Errors
///
/// [`LogError`] if a file is no log or has a plan on our topic, or `output` cannot be written.
pub fn join(logs: &[PathBuf], addition: &Addition<'_>, output: &Path) -> Result<u64, LogError> {
    let paths = bag::recording_files(logs, &mut Remarks::default())?;
    let maps = paths
        .iter()
        .map(|path| MappedFile::open(path).map_err(LogError::file("open", path)))
        .collect::<Result<Vec<_>, _>>()?;
    let mut parts = Vec::with_capacity(paths.len());
    let topics = Topics::default();
    let mut commands = true;
    for (path, map) in paths.iter().zip(&maps) {
        let layout = scan(map).ok_or_else(|| not_mcap(path, map))?;
        let copier = Copier::of(&layout);
        if copier.has(&topics.planned) {
            return Err(LogError::Planned { path: path.clone(), topic: topics.planned });
        }
        commands &= !copier.has(&topics.command);
        parts.push((layout, copier));
    }
    let written = write_atomically(output, |file| {
        let options = WriteOptions { log_delay_ns: addition.log_delay_ns, ..WriteOptions::default() };
        let log = LogWriter::new(file, &addition.joints, options)?;
        Ok(Joining { log, waiting: addition.samples.iter().peekable(), commands }.write(parts, addition)?)
    });
    written.map_err(|JoinError(source)| LogError::Copy { path: output.to_owned(), source })
}

/// Wraps whatever went wrong while writing.
struct JoinError(Failure);

impl From<AtomicError> for JoinError {
    fn from(error: AtomicError) -> Self {
        Self(Box::new(error))
    }
}

impl From<WriteError> for JoinError {
    fn from(error: WriteError) -> Self {
        Self(Box::new(error))
    }
}

impl From<Failure> for JoinError {
    fn from(error: Failure) -> Self {
        Self(error)
    }
}

struct Joining<'a, W: Write> {
    log: LogWriter<W>,
    waiting: Peekable<Iter<'a, PlanSample>>,
    commands: bool,
}

impl<W: Write> Joining<'_, W> {
    fn write(mut self, parts: Vec<(Layout<'_>, Copier)>, addition: &Addition<'_>) -> Result<u64, Failure> {
        let (name, entries) = &addition.metadata;
        let replaced: Vec<&str> =
            addition.files.iter().map(|file| file.name.as_str()).chain([*name]).collect();
        self.log.metadata(name, entries)?;
        let start_ns = addition.samples.first().map_or(0, |sample| sample.stamp_ns);
        for file in addition.files {
            self.log.attach(&file.name, &file.media_type, &file.data, start_ns)?;
        }
        let mut copied = 0;
        let mut blocks = Blocks::new();
        for (layout, mut copier) in parts {
            copy_files(self.log.raw(), &layout, &replaced)?;
            for block in &layout.blocks {
                let messages =
                    records(blocks.open(*block).0).filter(|record| record.opcode == Opcode::MESSAGE);
                for message in messages.filter_map(|record| MessageRecord::parse(record.body)) {
                    let log_ns = i64::try_from(message.log_time_ns).unwrap_or(i64::MAX);
                    self.catch_up(log_ns.saturating_sub(addition.log_delay_ns))?;
                    copied += u64::from(copier.message(self.log.raw(), &message)?);
                }
            }
        }
        self.catch_up(i64::MAX)?;
        self.log.finish()?;
        Ok(copied)
    }

    /// Writes the plan up to an instant.
    fn catch_up(&mut self, until_ns: i64) -> Result<(), WriteError> {
        while let Some(sample) = self.waiting.next_if(|sample| sample.stamp_ns <= until_ns) {
            let [angle_rad, speed_rad_s] = &sample.planned;
            self.log.joint_sample(Role::Planned, sample.stamp_ns, angle_rad, speed_rad_s, &[])?;
            if self.commands {
                let [angle_rad, speed_rad_s] = &sample.command;
                self.log.joint_sample(Role::Command, sample.stamp_ns, angle_rad, speed_rad_s, &[])?;
            }
        }
        Ok(())
    }
}
