//! Where plan and measurement of a run come from.

use crate::log::SourceInfo;

/// Headers that are named; of more, their number.
const MOST: usize = 3;

/// The plan: its topic and field, or the columns it was imported from.
pub(super) fn planned(source: &SourceInfo, between: &str) -> String {
    let headers = source.origin.as_ref().and_then(|origin| columns(&origin.file, &origin.planned));
    headers.unwrap_or_else(|| format!("{}{between}{}", source.planned_topic, source.planned_field))
}

/// The measurement, likewise.
pub(super) fn measured(source: &SourceInfo, between: &str) -> String {
    let headers = source
        .origin
        .as_ref()
        .and_then(|origin| columns(origin.measured_file.as_ref().unwrap_or(&origin.file), &origin.measured));
    headers.unwrap_or_else(|| format!("{}{between}{}", source.measured_topic, source.measured_field))
}

/// What dates the samples.
pub(super) fn clock(source: &SourceInfo) -> String {
    let of_origin = source.origin.as_ref().filter(|origin| !origin.time.is_empty());
    of_origin.map_or_else(|| format!("{} stamps", source.time_base.name()), |origin| origin.time.clone())
}

pub(super) fn why(source: &SourceInfo) -> String {
    match &source.origin {
        Some(_) => {
            "columns or fields by their words or as told; `hydrotrace import` lists them all".to_owned()
        }
        None => source.why.clone(),
    }
}

pub(super) fn why_clock(source: &SourceInfo) -> Option<&str> {
    source.origin.is_none().then_some(&source.time_base_why)
}

fn columns(file: &str, headers: &[String]) -> Option<String> {
    let (first, more) = (headers.get(..MOST.min(headers.len()))?, headers.len().saturating_sub(MOST));
    let more = if more == 0 { String::new() } else { format!(" and {more} more") };
    (!first.is_empty()).then(|| format!("{}{more} of {file}", first.join(", ")))
}
