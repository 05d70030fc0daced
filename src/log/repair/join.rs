//! A log with a plan put into it.

use std::{collections::BTreeMap, io::Write, iter::Peekable, path::Path, slice::Iter};

use super::copy::{Copier, CopyError, copy_files};
use crate::{
    atomic_file::write_atomically,
    log::{
        error::LogError,
        file::{Blocks, MessageRecord, Opcode, records},
        files::{ScannedFile, ScannedLog},
        joined::{self, RecordedIn},
        read::recording::Attachment,
        write::{LogWriter, Options, Role, Topics, WriteError},
    },
};

/// One instant of a plan, by joint: angle, rad, and speed, rad/s.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PlanSample {
    /// Header stamp, ns since 1970.
    pub stamp_ns: i64,
    /// Where the joints should be.
    pub planned: [Vec<f64>; 2],
    /// The command.
    pub command: [Vec<f64>; 2],
}

/// Samples, files and metadata to put into a log.
#[derive(Debug, Clone, PartialEq)]
pub struct Addition<'a> {
    /// The joints of the samples.
    pub joints: Vec<&'a str>,
    /// The plan, ascending in time.
    pub samples: Vec<PlanSample>,
    /// How much later than their stamps the log's messages were received, ns.
    pub log_delay_ns: i64,
    /// Topics and fields of what was sent, joined by a comma, if the log has them.
    pub sent: Option<[&'a str; 2]>,
    /// Units of what was recorded.
    pub recorded: RecordedIn,
    /// Whether the log has this plan on our topic, and keeps it.
    pub keeps_plan: bool,
    /// Whether what the log has on our topic is what was sent, and is left out.
    pub replaces_plan: bool,
    /// Files, in place of those of their names.
    pub files: &'a [Attachment],
    /// Names and entries of metadata, in place of those of these names.
    pub metadata: Vec<(&'a str, BTreeMap<String, String>)>,
}

impl ScannedLog<'_> {
    /// Writes all messages, files and metadata of the run to `output`, and the plan among them; the
    /// command too, where the log does not have its topic. Returns the number of messages copied.
    ///
    /// # Errors
    ///
    /// [`LogError`] if a file has another plan on our topic, or `output` cannot be written.
    pub fn join(&self, addition: &Addition<'_>, output: &Path) -> Result<u64, LogError> {
        let mut parts = Vec::with_capacity(self.files.len());
        let topics = Topics::default();
        let mut commands = true;
        for file in &self.files {
            let mut copier = Copier::of(file);
            if copier.has(&topics.planned) && !addition.keeps_plan && !addition.replaces_plan {
                return Err(LogError::Planned { path: file.path.to_owned(), topic: topics.planned });
            }
            commands &= !copier.has(&topics.command);
            if addition.replaces_plan {
                copier.leave_out(&topics.planned);
            }
            parts.push((file, copier));
        }
        let written = write_atomically::<_, CopyError>(output, |file| {
            let options = Options { log_delay_ns: addition.log_delay_ns, ..Options::default() };
            let log = LogWriter::new(file, &addition.joints, options)?;
            let plans = !addition.keeps_plan;
            Joining { log, waiting: addition.samples.iter().peekable(), plans, commands }
                .write(parts, addition)
        });
        written.map_err(|error| error.of(output))
    }
}

struct Joining<'a, W: Write> {
    log: LogWriter<W>,
    waiting: Peekable<Iter<'a, PlanSample>>,
    plans: bool,
    commands: bool,
}

impl<W: Write> Joining<'_, W> {
    fn write(
        mut self,
        parts: Vec<(&ScannedFile<'_>, Copier)>,
        addition: &Addition<'_>,
    ) -> Result<u64, CopyError> {
        let files = addition.files.iter().map(|file| file.name.as_str());
        let metadata = addition.metadata.iter().map(|(name, _)| *name);
        let replaced: Vec<&str> = files.chain(metadata).chain([joined::METADATA]).collect();
        for (name, entries) in &addition.metadata {
            self.log.metadata(name, entries)?;
        }
        let topics = Topics::default();
        let written = [(self.plans, &topics.planned), (self.commands, &topics.command)];
        let written: Vec<&str> =
            written.iter().filter(|(writes, _)| *writes).map(|(_, topic)| topic.as_str()).collect();
        let entries = joined::entries(addition.sent, &written, &addition.recorded);
        self.log.metadata(joined::METADATA, &entries)?;
        let start_ns = addition.samples.first().map_or(0, |sample| sample.stamp_ns);
        for file in addition.files {
            self.log.attach(&file.name, &file.media_type, &file.data, start_ns)?;
        }
        let mut copied = 0;
        let mut blocks = Blocks::new();
        for (file, mut copier) in parts {
            copy_files(self.log.raw(), file, &replaced)?;
            for block in &file.layout.blocks {
                let messages = records(blocks.open(*block, file.source).0)
                    .filter(|record| record.opcode == Opcode::MESSAGE);
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
            if self.plans {
                self.log.joint_sample(Role::Planned, sample.stamp_ns, angle_rad, speed_rad_s, &[])?;
            }
            if self.commands {
                let [angle_rad, speed_rad_s] = &sample.command;
                self.log.joint_sample(Role::Command, sample.stamp_ns, angle_rad, speed_rad_s, &[])?;
            }
        }
        Ok(())
    }
}
