//! `export`: what a report would use of a log, as a table.

use std::path::PathBuf;

use crate::{
    log::{AngleUnit, LogError, ReadOptions, RunTable, Selector, Topics, read_recording},
    remark::Remarks,
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

/// Reads a log and lays its run out as a table.
///
/// # Errors
///
/// [`LogError`], as for a report; or if there is no topic of the name given for the command.
pub fn run(inputs: &Inputs) -> Result<Outputs, LogError> {
    let recording = read_recording(&inputs.logs, &inputs.read)?;
    let usual = || Selector { topic: Topics::default().command, field: None };
    let sent = ReadOptions {
        planned: vec![inputs.command.clone().unwrap_or_else(usual)],
        time_base: Some(recording.source.time_base),
        ..inputs.read.clone()
    };
    let command = match read_recording(&inputs.logs, &sent) {
        // Where the plan is only known from the command there is no second one.
        Ok(command) => (command.source.planned_topic != recording.source.planned_topic).then_some(command),
        Err(error) if inputs.command.is_some() => return Err(error),
        Err(_) => None,
    };
    Ok(Outputs {
        table: RunTable::new(&recording, command.as_ref(), inputs.unit),
        remarks: recording.remarks,
    })
}
