//! `export`: plan, command and measurement of a log as a table, and charts of it for other programs.

mod charts;

use std::path::PathBuf;

pub use charts::{Chart, Charts, ChartsFailure, For, Shown, Worst, charts};

use crate::{
    log::{
        AngleUnit, Command, LogError, ReadOptions, RunTable, Selector, Sides, SignalRole, WantedSignal,
        read_recording,
    },
    remark::{Code, Remarks},
};

/// Input and form of an export.
#[derive(Debug, Clone)]
pub struct Inputs {
    /// Files or bag directories of one run.
    pub logs: Vec<PathBuf>,
    /// Topics, joints, clock and units, where the log alone does not determine them.
    pub read: ReadOptions,
    /// Topic of the command; `None`: that of our own logs, if it is there.
    pub command: Option<Selector>,
    /// Unit of the angles.
    pub unit: AngleUnit,
}

/// The result.
#[derive(Debug, Clone, PartialEq)]
pub struct Outputs {
    /// The run.
    pub table: RunTable,
    /// Doubts about the data.
    pub remarks: Remarks,
}

/// Reads a log and lays its run out as a table: plan, command and measurement, whichever there are.
///
/// # Errors
///
/// [`LogError`] if there is none of them, if plan and measurement share no joint, or if there is no topic of
/// the name given for the command.
pub fn run(inputs: &Inputs) -> Result<Outputs, LogError> {
    let command = WantedSignal { role: SignalRole::Command, topic: inputs.command.clone() };
    let both = ReadOptions { signals: vec![command], measured_velocities: true, ..inputs.read.clone() };
    let any = ReadOptions { sides: Sides::Any, ..both.clone() };
    // A side that only its words tell is sought where both are wanted.
    let mut recording =
        read_recording(&inputs.logs, &both).or_else(|_| read_recording(&inputs.logs, &any))?;
    let remarks = std::mem::take(&mut recording.remarks).without(Code::PlanIsCommand);
    let planned_topic = &recording.source.planned_topic;
    if recording.plan_is_command && inputs.command.is_none() {
        let (topic, series) = (planned_topic.clone(), std::mem::take(&mut recording.planned));
        recording.command = Some(Command { topic, series });
    } else if recording.command.as_ref().is_some_and(|command| command.topic == *planned_topic) {
        // The caller says that this command is the plan.
        recording.command = None;
    }
    Ok(Outputs { table: RunTable::new(&recording, inputs.unit), remarks })
}
