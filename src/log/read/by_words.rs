//! Reads a log without joints of a known type by the words of its fields.

use super::{extract::extract, recording::Recording, select_topics::MEASURED};
use crate::{
    log::{
        csv::{AngleUnit, CsvError, CsvOptions, CsvRun},
        error::LogError,
        files::{ScannedFile, ScannedLog, file_name},
        flat,
        import_line::Given,
        options::ReadOptions,
        write::Topics,
    },
    remark::{Code, Remarks},
};

/// What dates fields of messages.
const TIME: &str = "stamps of the messages";

/// The recording, of a log in which nothing was found and the caller named nothing; else the error that it was.
pub(super) fn recording(
    log: &ScannedLog<'_>,
    options: &ReadOptions,
    description: Option<String>,
    error: LogError,
) -> Result<Recording, LogError> {
    let named = !options.planned.is_empty() || !options.measured.is_empty();
    let (LogError::Missing { missing, .. }, false, Some(first)) = (&error, named, log.files.first()) else {
        return Err(error);
    };
    let degrees = options.planned_in_degrees && options.measured_in_degrees;
    let read = CsvOptions { angle_unit: degrees.then_some(AngleUnit::Degrees), ..CsvOptions::default() };
    let read = read.or(options.columns().map_err(|error| LogError::Map(Box::new(error)))?);
    let run = |lone| flat::run(log, &file_name(first.path), &read, lone);
    let options = ReadOptions {
        description: options.description.clone().or(description),
        planned_in_degrees: options.planned_in_degrees && !degrees,
        measured_in_degrees: options.measured_in_degrees && !degrees,
        ..options.clone()
    };
    // A plan of a form that is known goes with a measurement that is not.
    if *missing == MEASURED
        && let Some(Ok(run)) = run(true)
        && let Some(found) = recorded(log, &run.measured(), true, &options)
    {
        return Ok(found);
    }
    match run(false) {
        Some(Ok(run)) => recorded(log, &run, false, &options).ok_or(error),
        Some(Err(source @ (CsvError::AngleUnit { .. } | CsvError::Counts { .. })))
            if !flat::in_radians(log) =>
        {
            let (path, source) = (first.path.to_owned(), Box::new(source));
            Err(LogError::Table { path, source, given: Given::of(&options) })
        }
        _ => Err(error),
    }
}

/// The recording of a run, `beside` what else the log has or alone; `None` if it is none.
fn recorded(log: &ScannedLog<'_>, run: &CsvRun, beside: bool, options: &ReadOptions) -> Option<Recording> {
    let of = |side: &str| run.understood.columns.iter().find(|column| column.becomes == side);
    let plan = of("planned position").or_else(|| of("command position"));
    let measured = of("measured position")?;
    // Places in a list are counted from 0 here, and joints without a name elsewhere from 1.
    if beside && run.understood.columns.iter().any(|column| column.header.contains('[')) {
        return None;
    }
    let plan = match plan {
        _ if beside => String::new(),
        Some(plan) => format!("{:?} as the plan of {} and ", plan.header, plan.joint),
        None => return None,
    };
    let message = format!(
        "not all joints are in messages of a form that is known; fields were read by their words, such as {plan}{:?} as \
         the measurement of {}; else name them with --planned TOPIC:FIELD and --measured TOPIC:FIELD",
        measured.header.strip_suffix(flat::LONE).filter(|_| beside).unwrap_or(&measured.header),
        measured.joint
    );
    let mut remarks = if beside { log.remarks.clone() } else { Remarks::default() };
    remarks.add(Code::Guessed, 1, message);
    let moot = [Code::UnpairedJoint, Code::OneSide];
    for remark in run.remarks.as_slice().iter().filter(|one| !beside || !moot.contains(&one.code)) {
        remarks.add(remark.code, remark.count, remark.message.clone());
    }
    let source = run.write(Vec::new()).ok()?.into();
    let mut files = Vec::new();
    for one in log.files.iter().filter(|_| beside) {
        if files.last().is_none_or(|last: &ScannedFile<'_>| !std::ptr::eq(last.source, one.source)) {
            files.extend(ScannedFile::all(one.path, one.source).ok()?);
        }
    }
    files.extend(ScannedFile::all(log.files.first()?.path, &source).ok()?);
    let log = ScannedLog { files, ordered: true, described: log.described, remarks };
    let mut found = super::recording(extract(&log, options), options).ok()?;
    // A row that tells of some joints has no number of the others; those that are none were counted as they were read.
    let Topics { planned, measured, command, .. } = Topics::default();
    let own = |message: &str| {
        [&planned, &measured, &command].iter().any(|topic| message.contains(&format!(" {topic}:")))
    };
    found.remarks.retain(|remark| remark.code != Code::NotFinite || !own(&remark.message));
    if let Some(origin) = &mut found.source.origin {
        TIME.clone_into(&mut origin.time);
        for header in origin.measured.iter_mut().filter(|_| beside) {
            header.truncate(header.strip_suffix(flat::LONE).map_or(header.len(), str::len));
        }
    }
    Some(found)
}
