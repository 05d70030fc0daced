//! The files of one run as one log: parts of a recording, or plan and measurement in a file each.

use serde::{Deserialize, Serialize};

use super::{Inputs, JoinFailure};
use crate::{
    document::PROGRAM,
    log::{LogFiles, ReadOptions, Sides},
    remark::{Code, Remarks},
};

/// What the format is called.
const FORMAT: &str = "hydrotrace.gathered.v1";

/// What the new log holds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Gathered {
    /// Always "hydrotrace.gathered.v1".
    pub format: String,
    /// Name and version of the program that wrote it.
    pub program: String,
    /// Files that were read.
    pub files: usize,
    /// Messages that were copied.
    pub messages: u64,
    /// Joints whose measurement was read.
    pub joints: usize,
    /// Joints whose plan was read; none of a measurement alone.
    #[serde(default)]
    pub planned_joints: usize,
    /// From the first to the last sample, planned or measured, s.
    pub duration_s: f64,
    /// Doubts about the data.
    pub remarks: Remarks,
}

/// Writes the files of one run as one log.
///
/// # Errors
///
/// [`JoinFailure`] if they hold no measurement or are not of one run; nothing is written then.
pub fn gather(inputs: &Inputs) -> Result<Gathered, JoinFailure> {
    inputs.check_output()?;
    // Messages are copied as they are: what becomes of lengths is for the verb that reads them.
    let read = ReadOptions { sides: Sides::MeasurementAtLeast, cylinders: None, ..inputs.read.clone() };
    let files = LogFiles::with(inputs.logs.iter().cloned(), &read)?;
    let log = files.scan()?;
    let mut run = log.read(&read)?;
    let [from_s, to_s] = run.measured.span_s().unwrap_or_default();
    if let Some(planned_s) =
        run.planned.span_s().filter(|[begins_s, ends_s]| *begins_s > to_s || *ends_s < from_s)
    {
        return Err(JoinFailure::Apart {
            planned_s,
            measured_s: [from_s, to_s],
            output: inputs.output.clone(),
        });
    }
    let ends_s = run.planned.span_s().into_iter().chain([[from_s, to_s]]);
    let [least_s, most_s] =
        ends_s.fold([from_s, to_s], |[a, b], [begins_s, ends_s]| [a.min(begins_s), b.max(ends_s)]);
    let (files, messages, unknown) = log.gather(&inputs.output)?;
    run.remarks.add(
        Code::UnknownChannel,
        unknown,
        "messages of channels that their file does not define, left out",
    );
    Ok(Gathered {
        format: FORMAT.to_owned(),
        program: PROGRAM.to_owned(),
        files,
        messages,
        joints: run.measured.tracks.len(),
        planned_joints: run.planned.tracks.len(),
        duration_s: most_s - least_s,
        remarks: run.remarks,
    })
}
