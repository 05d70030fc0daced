//! `report`: from a log to the tracking error of every joint and transition.

pub mod advice;
mod analysis;
mod document;
mod gates;
mod identity;
mod outcome;

use std::path::PathBuf;

use analysis::aligned;
pub use analysis::{Analysis, analyse};
pub use document::Document;
pub use gates::{GateResult, Gates};
pub use identity::{LogFile, log_files};
pub use outcome::{Alignment, Report};

use super::{
    carried::{Carried, PLAN, Schedule},
    plan::PlanDocument,
};
use crate::{
    log::{LogError, ReadOptions, Recording, read_recording},
    remark::{Code, Remarks},
    replay::{Profiles, Rules},
};

/// What to analyse, how, and what must hold.
#[derive(Debug, Clone, Default)]
pub struct Inputs {
    /// Files or bag directories of one run.
    pub logs: Vec<PathBuf>,
    /// What to read, where the log alone does not tell.
    pub read: ReadOptions,
    /// Thresholds and windows.
    pub rules: Rules,
    /// Limits that the caller sets.
    pub gates: Gates,
}

/// Analyses one run.
///
/// # Errors
///
/// [`LogError`] if the log cannot be read or holds no planned and measured joints.
///
/// ```
/// use hydrotrace::workflow::report::{Inputs, run};
///
/// let logs = vec!["sample-logs/panel-install.mcap".into()];
/// let report = run(&Inputs { logs, ..Inputs::default() })?;
/// assert!(report.replay.transitions.len() > 10 && report.gates_kept());
/// # Ok::<(), hydrotrace::log::LogError>(())
/// ```
pub fn run(inputs: &Inputs) -> Result<Report, LogError> {
    report(read_recording(&inputs.logs, &inputs.read)?, inputs)
}

/// Analyses the recording that was read of the logs.
///
/// # Errors
///
/// [`LogError`] if plan and measurement never overlap.
pub fn report(mut recording: Recording, inputs: &Inputs) -> Result<Report, LogError> {
    let carried = Carried::of(&recording);
    let mut remarks = recording.remarks.clone();
    let (alignment, pairs) = aligned(&recording, &inputs.rules, &mut remarks);
    if pairs.is_empty() {
        let sides = [&recording.planned, &recording.measured];
        let [planned_s, measured_s] = sides.map(|side| side.span_s().unwrap_or_default());
        return Err(LogError::NoOverlap { planned_s, measured_s });
    }
    // A long run's series take as much memory as its pairs.
    (recording.planned, recording.measured) = Default::default();
    let Analysis { alignment, pairs, replay } = Analysis::of(alignment, pairs, &inputs.rules);
    let gates = inputs.gates.judge(&replay);
    let front = front(&carried, &mut remarks);
    let name = |path: &PathBuf| path.file_name().map(|name| name.to_string_lossy().into_owned());
    let named = |key: &str| recording.metadata.values().find_map(|entries| entries.get(key).cloned());
    Ok(Report {
        logs: inputs.logs.iter().filter_map(name).collect(),
        paths: inputs.logs.clone(),
        machine: named("machine"),
        run: named("run"),
        promised: carried
            .promise()
            .map(|promise| promise.held(replay.transitions.iter().map(|t| t.peak_error))),
        holds_task: carried.task().is_some(),
        schedule: Schedule::of(&carried),
        source: recording.source,
        alignment,
        replay,
        gates,
        remarks,
        profiles: Profiles::of(&pairs),
        pairs,
        front,
    })
}

fn front(carried: &Carried, remarks: &mut Remarks) -> Option<PlanDocument> {
    match carried.plan()? {
        Ok(plan) => Some(plan),
        Err(error) => {
            remarks.add(Code::NotSupported, 1, format!("{PLAN} in the log is broken, left out: {error}"));
            None
        }
    }
}
