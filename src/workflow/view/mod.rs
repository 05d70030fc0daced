//! `view`: from the logs of runs to scenes: moving arms, series, events, fronts.

mod arm;
mod mesh;

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

use thiserror::Error;

pub use arm::{ArmOrigin, MovingArm, Poses, Sight};

use super::{
    carried::Carried,
    plan::PlanDocument,
    report::{Analysis, analyse},
};
use crate::{
    arm::ArmError,
    input_file,
    log::{LogError, ReadOptions, Recording, Sides, read_recording},
    remark::Remarks,
    replay::{Rules, Transition},
    series::{Pair, Series},
};

/// Input of a view.
#[derive(Debug, Clone, Default)]
pub struct Inputs {
    /// Runs or plans, each a file or a bag directory.
    pub logs: Vec<PathBuf>,
    /// Topics, joints, clock and units, where a log alone does not determine them.
    pub read: ReadOptions,
    /// Thresholds of transitions.
    pub rules: Rules,
    /// The description of the arm, whatever the logs say of it.
    pub urdf: Option<PathBuf>,
    /// Folders that hold packages of meshes, or are one.
    pub packages: Vec<PathBuf>,
}

/// Why a view cannot be made.
#[derive(Debug, Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the message says what each field is")]
pub enum ViewFailure {
    #[error(transparent)]
    Log(#[from] LogError),
    #[error("cannot read {}", path.display())]
    Read { path: PathBuf, source: std::io::Error },
    #[error("the joints {} of the log turn no arm of the description", joints.join(", "))]
    Arm { joints: Vec<String>, source: ArmError },
}

/// One run or plan.
#[derive(Debug, Clone)]
pub struct Scene {
    /// Name of its log, distinct among those shown.
    pub name: String,
    /// The plan.
    pub planned: Series,
    /// The measurement; empty for a plan that was not run.
    pub measured: Series,
    /// Plan and measurement where both exist, by joint.
    pub pairs: Vec<Pair>,
    /// Starts and reversals with what came of them.
    pub transitions: Vec<Transition>,
    /// The arm, if there is one of these joints.
    pub arm: Option<MovingArm>,
    /// Plans to choose from, if the log holds them.
    pub front: Option<PlanDocument>,
    /// Doubts about the data.
    pub remarks: Remarks,
}

/// Reads and places everything that is to be seen.
///
/// # Errors
///
/// [`ViewFailure`] if a log cannot be read or holds no planned joints, or a description that is given does
/// not fit it.
pub fn run(inputs: &Inputs) -> Result<Vec<Scene>, ViewFailure> {
    let given = inputs.urdf.as_deref().map(|path| match input_file::read_to_string(path) {
        Ok(text) => Ok((path, text)),
        Err(source) => Err(ViewFailure::Read { path: path.to_owned(), source }),
    });
    let given = given.transpose()?;
    let mut taken: BTreeMap<String, u32> = BTreeMap::new();
    let scenes = inputs.logs.iter().map(|path| {
        let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let count = taken.entry(stem.clone()).or_default();
        *count += 1;
        let name = if *count == 1 { stem } else { format!("{stem}-{count}") };
        scene(path, name, inputs, given.as_ref().map(|(file, text)| (*file, text.as_str())))
    });
    scenes.collect()
}

fn scene(
    path: &Path,
    name: String,
    inputs: &Inputs,
    given: Option<(&Path, &str)>,
) -> Result<Scene, ViewFailure> {
    let paths = [path.to_owned()];
    // A plan that nobody ran yet has no measurement.
    let read = ReadOptions { sides: Sides::PlanAtLeast, ..inputs.read.clone() };
    let mut recording = read_recording(&paths, &read)?;
    let mut doubts = Remarks::default();
    let Analysis { pairs, replay, .. } = analyse(&recording, &inputs.rules, &mut doubts);
    recording.remarks.extend(doubts);
    let arm = arm::find(&mut recording, given, &inputs.packages)?;
    let front = Carried::of(&recording).plan().and_then(Result::ok);
    let Recording { planned, measured, remarks, .. } = recording;
    Ok(Scene { name, planned, measured, pairs, transitions: replay.transitions, arm, front, remarks })
}
