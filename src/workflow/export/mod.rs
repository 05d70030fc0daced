//! `export`: plan, command and measurement of a log as a table.

use std::path::PathBuf;

use crate::{
    log::{
        AngleUnit, LogError, ReadOptions, Recording, RunTable, Selector, Topics, read_measured, read_plan,
        read_recording,
    },
    remark::{Code, Remarks},
    series::Series,
};

/// What to export.
#[derive(Debug, Clone)]
pub struct Inputs {
    /// Files or bag directories of one run.
    pub logs: Vec<PathBuf>,
    /// What to read, where the log alone does not tell.
    pub read: ReadOptions,
    /// Topic of what was really sent; `None`: that of our own logs, if it is there.
    pub command: Option<Selector>,
    /// Unit of the angles.
    pub unit: AngleUnit,
}

/// What came of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Outputs {
    /// The run.
    pub table: RunTable,
    /// What was doubtful.
    pub remarks: Remarks,
}

/// Reads a log and lays its run out as a table: plan, command and measurement, whichever there are.
///
/// # Errors
///
/// [`LogError`] if there is none of them, if plan and measurement share no joint, or if there is no topic of
/// the name given for the command.
pub fn run(inputs: &Inputs) -> Result<Outputs, LogError> {
    let recording = read(inputs)?;
    let remarks = recording.remarks.clone().without(Code::PlanIsCommand);
    if recording.plan_is_command && inputs.command.is_none() {
        let none = Series::default();
        let run = Recording { planned: none, ..recording.clone() };
        return Ok(Outputs { table: RunTable::new(&run, Some(&recording), inputs.unit), remarks });
    }
    let command = match read_command(inputs, &recording) {
        // Where the plan is only known from the command there is no second one.
        Ok(command) => (command.source.planned_topic != recording.source.planned_topic).then_some(command),
        Err(error) if inputs.command.is_some() => return Err(error),
        Err(_) => None,
    };
    Ok(Outputs { table: RunTable::new(&recording, command.as_ref(), inputs.unit), remarks })
}

/// Plan and measurement, or the one that there is.
fn read(inputs: &Inputs) -> Result<Recording, LogError> {
    let (logs, options) = (&inputs.logs, &inputs.read);
    match read_recording(logs, options) {
        Err(LogError::Missing { missing: "measured", .. }) => read_plan(logs, options),
        Err(LogError::Missing { missing: "planned", .. }) => match read_measured(logs, options) {
            Err(LogError::Missing { present, .. }) => Err(LogError::Missing {
                missing: "planned, commanded or measured",
                present,
                flag: "--planned or --measured",
            }),
            other => other,
        },
        other => other,
    }
}

/// What was sent, as the plan of a recording on the same clock.
fn read_command(inputs: &Inputs, run: &Recording) -> Result<Recording, LogError> {
    let usual = || Selector { topic: Topics::default().command, field: None };
    let sent = ReadOptions {
        planned: vec![inputs.command.clone().unwrap_or_else(usual)],
        time_base: Some(run.source.time_base),
        ..inputs.read.clone()
    };
    let alone = run.measured.tracks.is_empty();
    if alone { read_plan(&inputs.logs, &sent) } else { read_recording(&inputs.logs, &sent) }
}
