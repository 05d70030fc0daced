//! What our logs carry beside samples: task, arm, plan, where they come from. Names are spelt here and nowhere else.

pub mod arm_log;
pub mod plan_log;
mod promise;
pub mod rest;
mod schedule;
pub mod stamp;
mod worth;

use std::{
    collections::BTreeMap,
    io::Write,
    path::{Component, Path},
};

pub use promise::{Held, Promise};
pub use schedule::Schedule;
use sha2::{Digest, Sha256};
pub use worth::worth;

use super::plan::{PlanDocument, PlanEntry, PlanFailure, TaskFiles};
use crate::{
    arm::{Arm, Chain},
    fit::is_excitation,
    input_file,
    log::{Attachment, JOINT_KINDS, LogWriter, Recording, WriteError, joint_kinds},
    plant::Truth,
    remark::{Code, Remarks},
    series::{Broken, Track},
    task::{ArmSource, Task, TaskError},
};

/// Name of the attached task.
const TASK: &str = "task.toml";
/// Name of an attached task of which only the arm counts: the log holds another motion.
const ARM: &str = "arm.toml";
/// Names of the attached files of the task's arm.
const URDF: &str = "robot.urdf";
const HYDRAULICS: &str = "hydraulics.toml";
/// Name of the attached plan.
pub const PLAN: &str = "plan.json";
/// Name of the metadata that say where a plan comes from.
const PROVENANCE: &str = "hydrotrace.plan";
/// Key of the provenance: when the times of the plan count from, s since the start of the log; 0 without.
const STARTS: &str = "starts_s";
/// Key of the provenance: the verb that made the plan, where it is not `plan`.
pub(super) const MADE_BY: &str = "made_by";
/// That of an identification run.
pub(super) const EXCITE: &str = "excite";
/// Key of the provenance: where the controller takes trajectories; ours without.
const TRAJECTORY: &str = "trajectory_topic";
/// Start of the keys of the provenance that hold the SHA-256 of the files, by name.
const SHA256: &str = "sha256.";
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
    /// Names of files that are not those that were written, by their SHA-256.
    altered: Vec<String>,
    /// What is said of joints that slide.
    kinds: BTreeMap<String, String>,
}

impl Carried {
    /// What a log carries; files of other programs are left out.
    pub fn of(recording: &Recording) -> Self {
        let ours = |file: &&Attachment| [TASK, ARM, PLAN, URDF, HYDRAULICS].contains(&file.name.as_str());
        let mut files: Vec<Attachment> = recording.attachments.iter().filter(ours).cloned().collect();
        files.dedup_by(|a, b| a.name == b.name);
        let mut provenance = recording.metadata.get(PROVENANCE).cloned().unwrap_or_default();
        let altered = |file: &&Attachment| {
            let written = provenance.get(&format!("{SHA256}{}", file.name));
            written.is_some_and(|hash| *hash != sha256(file))
        };
        let altered = files.iter().filter(altered).map(|file| file.name.clone()).collect();
        provenance.retain(|key, _| !key.starts_with(SHA256));
        let carried = Self { files, provenance, altered, ..Self::default() };
        carried.with_kinds_of(recording.planned.tracks.iter().chain(&recording.measured.tracks))
    }

    /// With what is said of those joints that slide.
    pub fn with_kinds_of<'a>(self, tracks: impl Iterator<Item = &'a Track>) -> Self {
        Self { kinds: joint_kinds(tracks.map(|track| (track.name(), track.kind()))), ..self }
    }

    /// The same of the joints of an arm.
    pub fn with_kinds_of_arm(self, arm: &Chain) -> Self {
        Self { kinds: joint_kinds(arm.joints().iter().map(|joint| (&*joint.name, joint.kind))), ..self }
    }

    /// Where the plan of a log is broken, unless the log holds its task, which tells the plan exactly.
    pub(in crate::workflow) fn broken(&self, recording: &Recording) -> Option<Broken> {
        let known = self.task().is_some() && self.chosen().is_some();
        if known { None } else { Broken::of(&recording.planned) }
    }

    /// A task with its arm, and a plan of it.
    pub fn with_plan(self, task: &TaskFiles, plan: &PlanDocument) -> Self {
        let mut files = attached(TASK, task);
        files.push(attachment(PLAN, "application/json", &plan.json()));
        Self { files, ..self }
    }

    /// A task of which only the arm counts.
    pub fn with_arm_of(self, task: &TaskFiles) -> Self {
        Self { files: attached(ARM, task), ..self }
    }

    /// Whether a run is one of identification, as its log says or, of another recorder, its plan shows: no task is done by it.
    pub(in crate::workflow) fn identifies(recording: &Recording) -> bool {
        Self::of(recording).provenance.get(MADE_BY).is_some_and(|by| by == EXCITE)
            || is_excitation(&recording.planned)
    }

    /// The provenance in place of what was there.
    pub fn with_provenance(self, provenance: BTreeMap<String, String>) -> Self {
        Self { provenance, ..self }
    }

    /// When the times of the plan count from, s since the start of the log.
    pub fn with_starts_s(mut self, starts_s: f64) -> Self {
        self.provenance.insert(STARTS.to_owned(), starts_s.to_string());
        self
    }

    /// Where the controller takes trajectories.
    pub fn with_trajectory_topic(mut self, topic: &str) -> Self {
        self.provenance.insert(TRAJECTORY.to_owned(), topic.to_owned());
        self
    }

    /// What is expected of the run of this command.
    pub fn with_promise(mut self, promise: &Promise) -> Self {
        self.provenance.extend(promise.entries());
        self
    }

    /// What was expected of the run, if its command came with a promise.
    pub fn promise(&self) -> Option<Promise> {
        Promise::of(&self.provenance)
    }

    /// Without a task of which only the arm counts.
    pub fn of_plan(mut self) -> Self {
        if self.file(ARM).is_some() {
            self.files.retain(|file| ![ARM, URDF, HYDRAULICS].contains(&file.name.as_str()));
        }
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

    /// The task with the files of its arm, or of the one of which only the arm counts.
    pub fn task_files(&self) -> Option<TaskFiles> {
        let task = self.task().or_else(|| self.text(ARM))?;
        Some(TaskFiles { task, urdf: self.text(URDF), hydraulics: self.text(HYDRAULICS) })
    }

    /// The arm of the task.
    ///
    /// # Errors
    ///
    /// Within, if the arm's files are broken or were not carried.
    pub fn arm(&self) -> Option<Result<Arm, PlanFailure>> {
        Some(self.task_files()?.arm(&Task::parse(&self.task()?).ok()?))
    }

    /// The arm of the task, or of the one of which only the arm counts; `None` too if that is broken.
    pub fn task_arm(&self) -> Option<Arm> {
        self.task_files()?.arm(&self.task_or_arm()?.ok()?).ok()
    }

    /// Says which files are not those that were written.
    pub fn remark_altered(&self, remarks: &mut Remarks) {
        for name in &self.altered {
            let message = format!(
                "{name} in the log is not the one that was written into it, by its SHA-256; it is used as it is"
            );
            remarks.add(Code::OtherFile, 1, message);
        }
    }

    /// Says of files beside the log that they are not those of the arm that it carries, which counts.
    pub fn remark_others(&self, log: &Path, remarks: &mut Remarks) {
        self.remark_altered(remarks);
        let Some(files) = self.task_files() else { return };
        let Ok(Task { arm: ArmSource::File { urdf, hydraulics, .. }, .. }) = Task::parse(&files.task) else {
            return;
        };
        let folder = log.parent().unwrap_or(Path::new(""));
        for (name, carried) in [(Some(urdf), files.urdf), (hydraulics, files.hydraulics)] {
            let (Some(name), Some(carried)) = (name, carried) else { continue };
            // Of what a log names only a plain name is looked at, and only a file.
            let plain =
                matches!(Path::new(&name).components().collect::<Vec<_>>()[..], [Component::Normal(_)]);
            let beside = folder.join(&name);
            if plain
                && beside.is_file()
                && input_file::read_to_string(&beside).is_ok_and(|text| text != carried)
            {
                let message = format!(
                    "{name} beside the log is not the one that its plan was made with, which the log carries and which \
                     is used; plan again for the other"
                );
                remarks.add(Code::OtherFile, 1, message);
            }
        }
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
        Some(self.chosen()?.times_s)
    }

    /// The chosen plan, if its times are known.
    pub fn chosen(&self) -> Option<PlanEntry> {
        Some(self.plan()?.ok()?.chosen.entry).filter(|entry| !entry.times_s.is_empty())
    }

    /// When the times of the plan count from, s since the start of the log.
    pub fn starts_s(&self) -> Option<f64> {
        self.provenance.get(STARTS)?.parse().ok().filter(|s: &f64| s.is_finite())
    }

    /// Where the controller takes trajectories, if a log before this one told it.
    pub fn trajectory_topic(&self) -> Option<&str> {
        self.provenance.get(TRAJECTORY).map(String::as_str)
    }

    /// Names and entries of the metadata, with the SHA-256 of every file where an arm's are among them: the sample arm
    /// is the program's own.
    pub fn metadata(&self) -> Vec<(&'static str, BTreeMap<String, String>)> {
        let hash = |file: &Attachment| (format!("{SHA256}{}", file.name), sha256(file));
        let mut entries = self.provenance.clone();
        if self.file(URDF).is_some() {
            entries.extend(self.files.iter().map(hash));
        }
        let kinds = (!self.kinds.is_empty()).then(|| (JOINT_KINDS, self.kinds.clone()));
        std::iter::once((PROVENANCE, entries)).chain(kinds).collect()
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
        self.metadata().iter().try_for_each(|(name, entries)| log.metadata(name, entries))
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

fn sha256(file: &Attachment) -> String {
    format!("{:x}", Sha256::digest(&file.data))
}

fn attachment(name: &str, media_type: &str, data: &str) -> Attachment {
    Attachment { name: name.to_owned(), media_type: media_type.to_owned(), data: data.as_bytes().to_vec() }
}

/// A task under a name, and the files of its arm.
fn attached(name: &str, task: &TaskFiles) -> Vec<Attachment> {
    let mut files = vec![attachment(name, "application/toml", &task.task)];
    files.extend(task.urdf.iter().map(|text| attachment(URDF, "application/xml", text)));
    files.extend(task.hydraulics.iter().map(|text| attachment(HYDRAULICS, "application/toml", text)));
    files
}

/// Writes what a fit should find of a simulated machine.
pub(super) fn write_truth<W: Write>(log: &mut LogWriter<W>, truth: &Truth) -> Result<(), WriteError> {
    let truth = serde_json::to_string(truth).unwrap_or_default();
    log.metadata(TRUTH, &BTreeMap::from([(JSON.to_owned(), truth)]))
}
