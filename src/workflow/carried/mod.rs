//! What our logs carry beside samples: task, arm, plan, where they come from. Names are spelt here and nowhere else.

pub mod arm_log;
pub mod plan_log;
pub mod rest;
mod schedule;
pub mod stamp;

use std::{collections::BTreeMap, io::Write, path::Path};

pub use schedule::Schedule;

use super::plan::{PlanDocument, PlanFailure, arm_of};
use crate::{
    arm::Arm,
    log::{Attachment, LogWriter, Recording, WriteError},
    plant::Truth,
    task::{Task, TaskError},
};

/// Name of the attached task.
const TASK: &str = "task.toml";
/// Name of an attached task of which only the arm counts: the log holds another motion.
const ARM: &str = "arm.toml";
/// Name of the attached plan.
pub const PLAN: &str = "plan.json";
/// Name of the metadata that say where a plan comes from.
const PROVENANCE: &str = "hydrotrace.plan";
/// Key of the provenance: when the times of the plan count from, s since the start of the log; 0 without.
const STARTS: &str = "starts_s";
/// Name of the metadata that hold a simulated machine's truth, as JSON under the key [`JSON`].
const TRUTH: &str = "hydrotrace.plant";
const JSON: &str = "json";

/// Files and provenance of a log.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Carried {
    /// Files of ours, byte by byte as they were read.
    files: Vec<Attachment>,
    /// Where the plan comes from.
    provenance: BTreeMap<String, String>,
}

impl Carried {
    /// What a log carries; files of other programs are left out.
    pub fn of(recording: &Recording) -> Self {
        let ours = |file: &&Attachment| [TASK, ARM, PLAN].contains(&file.name.as_str());
        let mut files: Vec<Attachment> = recording.attachments.iter().filter(ours).cloned().collect();
        files.dedup_by(|a, b| a.name == b.name);
        Self { files, provenance: recording.metadata.get(PROVENANCE).cloned().unwrap_or_default() }
    }

    /// A task and a plan of it.
    #[must_use]
    pub fn with_plan(self, task: &str, plan: &PlanDocument) -> Self {
        let file = |name: &str, kind: &str, data: &str| Attachment {
            name: name.to_owned(),
            media_type: kind.to_owned(),
            data: data.as_bytes().to_vec(),
        };
        let files = vec![file(TASK, "application/toml", task), file(PLAN, "application/json", &plan.json())];
        Self { files, ..self }
    }

    /// A task of which only the arm counts.
    #[must_use]
    pub fn with_arm_of(self, task: &str) -> Self {
        let (name, media_type) = (ARM.to_owned(), "application/toml".to_owned());
        Self { files: vec![Attachment { name, media_type, data: task.as_bytes().to_vec() }], ..self }
    }

    /// The provenance in place of what was there.
    #[must_use]
    pub fn with_provenance(self, provenance: BTreeMap<String, String>) -> Self {
        Self { provenance, ..self }
    }

    /// When the times of the plan count from, s since the start of the log.
    #[must_use]
    pub fn with_starts_s(mut self, starts_s: f64) -> Self {
        self.provenance.insert(STARTS.to_owned(), starts_s.to_string());
        self
    }

    /// Without a task of which only the arm counts.
    #[must_use]
    pub fn of_plan(mut self) -> Self {
        self.files.retain(|file| file.name != ARM);
        self
    }

    fn file(&self, name: &str) -> Option<&[u8]> {
        self.files.iter().find(|file| file.name == name).map(|file| file.data.as_slice())
    }

    fn text(&self, name: &str) -> Option<String> {
        self.file(name).map(|data| String::from_utf8_lossy(data).into_owned())
    }

    /// Names of the files.
    pub fn names(&self) -> Vec<String> {
        self.files.iter().map(|file| file.name.clone()).collect()
    }

    /// Text of the task.
    pub fn task(&self) -> Option<String> {
        self.text(TASK)
    }

    /// The task, or the one of which only the arm counts.
    ///
    /// # Errors
    ///
    /// Within, if its text is broken.
    pub fn task_or_arm(&self) -> Option<Result<Task, TaskError>> {
        Some(Task::parse(&self.task().or_else(|| self.text(ARM))?))
    }

    /// The arm of the task in a log of this folder.
    ///
    /// # Errors
    ///
    /// Within, if the arm's files are broken.
    pub fn arm(&self, folder: &Path) -> Option<Result<Arm, PlanFailure>> {
        Some(arm_of(&Task::parse(&self.task()?).ok()?, folder))
    }

    /// The plan; `None` without a plan document of ours.
    ///
    /// # Errors
    ///
    /// Within, if it is broken.
    pub fn plan(&self) -> Option<Result<PlanDocument, serde_json::Error>> {
        PlanDocument::read(self.file(PLAN)?)
    }

    /// Arrivals of the chosen plan at the key points, s.
    pub fn times_s(&self) -> Option<Vec<f64>> {
        Some(self.plan()?.ok()?.chosen.entry.times_s).filter(|times_s| !times_s.is_empty())
    }

    /// When the times of the plan count from, s since the start of the log.
    pub fn starts_s(&self) -> Option<f64> {
        self.provenance.get(STARTS)?.parse().ok().filter(|s: &f64| s.is_finite())
    }

    /// Name and entries of the metadata.
    pub fn metadata(&self) -> (&'static str, BTreeMap<String, String>) {
        (PROVENANCE, self.provenance.clone())
    }

    /// The files.
    pub fn files(&self) -> &[Attachment] {
        &self.files
    }

    /// Writes the metadata, before the samples.
    ///
    /// # Errors
    ///
    /// [`WriteError`].
    pub fn begin<W: Write>(&self, log: &mut LogWriter<W>) -> Result<(), WriteError> {
        log.metadata(PROVENANCE, &self.provenance)
    }

    /// Writes the files, after the samples, stamped with the start of the log.
    ///
    /// # Errors
    ///
    /// [`WriteError`].
    pub fn end<W: Write>(&self, log: &mut LogWriter<W>, start_ns: i64) -> Result<(), WriteError> {
        self.files.iter().try_for_each(|file| log.attach(&file.name, &file.media_type, &file.data, start_ns))
    }
}

/// Writes what a fit should find of a simulated machine.
pub(super) fn write_truth<W: Write>(log: &mut LogWriter<W>, truth: &Truth) -> Result<(), WriteError> {
    let truth = serde_json::to_string(truth).unwrap_or_default();
    log.metadata(TRUTH, &BTreeMap::from([(JSON.to_owned(), truth)]))
}
