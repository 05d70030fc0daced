//! Reads a log without joints of a known type by the words of its fields.

use super::{extract::extract, recording::Recording};
use crate::{
    log::{
        csv::{AngleUnit, CsvError, CsvOptions},
        error::LogError,
        files::{ScannedFile, ScannedLog, file_name},
        flat,
        options::ReadOptions,
    },
    remark::{Code, Remarks},
};

/// The recording, of a log in which nothing was found and the caller named nothing; else the error that it was.
pub(super) fn recording(
    log: &ScannedLog<'_>,
    options: &ReadOptions,
    description: Option<String>,
    error: LogError,
) -> Result<Recording, LogError> {
    let named = !options.planned.is_empty() || !options.measured.is_empty();
    let (true, Some(first)) = (matches!(error, LogError::Missing { .. }) && !named, log.files.first()) else {
        return Err(error);
    };
    let degrees = options.planned_in_degrees && options.measured_in_degrees;
    let read = CsvOptions { angle_unit: degrees.then_some(AngleUnit::Degrees), ..CsvOptions::default() };
    let run = match flat::run(log, &file_name(first.path), &read) {
        Some(Ok(run)) => run,
        Some(Err(source @ (CsvError::AngleUnit { .. } | CsvError::Counts { .. }))) => {
            return Err(LogError::Table { path: first.path.to_owned(), source: Box::new(source) });
        }
        _ => return Err(error),
    };
    let of = |side: &str| run.understood.columns.iter().find(|column| column.becomes == side);
    let sides = [of("planned position").or_else(|| of("command position")), of("measured position")];
    let [Some(plan), Some(measured)] = sides else { return Err(error) };
    let message = format!(
        "no topic has joints in a form that is known; fields were read by their words, such as {:?} as the plan of {} and \
         {:?} as its measurement; else name them with --planned TOPIC:FIELD and --measured TOPIC:FIELD",
        plan.header, plan.joint, measured.header
    );
    let mut remarks = Remarks::default();
    remarks.add(Code::Guessed, 1, message);
    remarks.extend(run.remarks.clone());
    let Ok(bytes) = run.write(Vec::new()) else { return Err(error) };
    let source = bytes.into();
    let Ok(file) = ScannedFile::of(first.path, &source) else { return Err(error) };
    let log = ScannedLog { files: vec![file], ordered: true, remarks };
    let options = ReadOptions {
        description: options.description.clone().or(description),
        planned_in_degrees: options.planned_in_degrees && !degrees,
        measured_in_degrees: options.measured_in_degrees && !degrees,
        ..options.clone()
    };
    super::recording(extract(&log, &options), &options)
}
