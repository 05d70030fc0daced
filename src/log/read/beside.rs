//! Where the signals beside plan and measurement are.

use super::{
    candidates::{Candidate, named},
    content::{Content, Extracted},
    overlap,
};
use crate::log::{
    error::LogError,
    options::{ReadOptions, SignalRole, TimeBase, WantedSignal},
    source::Role,
};

/// A signal, and where it is.
type Found<'a> = (&'a WantedSignal, Vec<Candidate>);

/// The signals that are wanted; those that are not there, where none was named, are no fault.
pub(super) fn of<'a>(
    extracted: &Extracted,
    options: &'a ReadOptions,
    base: TimeBase,
) -> Result<Vec<Found<'a>>, LogError> {
    let found = options.signals.iter().map(|wanted| match one(extracted, wanted, base) {
        Err(error) if wanted.topic.is_some() => Err(error),
        found => Ok(found.ok().map(|found| (wanted, found))),
    });
    Ok(found.collect::<Result<Vec<_>, _>>()?.into_iter().flatten().collect())
}

/// Where a signal is, on a clock that runs.
fn one(extracted: &Extracted, wanted: &WantedSignal, base: TimeBase) -> Result<Vec<Candidate>, LogError> {
    let role = if wanted.role == SignalRole::Command { Role::Planned } else { Role::Beside };
    let found = named(extracted, &wanted.selector(), role)?;
    let tables = found.iter().filter_map(|c| match &extracted.sources[c.source].content {
        Content::Table(table) => Some((c, table)),
        _ => None,
    });
    if let Some((stopped, _)) = tables.into_iter().find(|(_, table)| !table.stamps.runs(base)) {
        let topic = extracted.topic_of(stopped.source).topic.clone();
        return Err(LogError::NoClock { clock: base.name(), topic });
    }
    overlap::check(extracted, &found, base)?;
    Ok(found)
}
