//! `fleet note`: what was done to a machine, and when; `fleet effect` asks what it did.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::{
    arrange::place_of,
    effect::{Effect, effect},
    failure::FleetFailure,
    history::{By, Filter, History},
    run::date,
    store::{Part, Store, parts},
    tables::Name,
};
use crate::{
    document::PROGRAM,
    log::dataset::{Cell, Table, read_table},
    units::SECONDS_PER_DAY,
    workflow::report::hash,
};

/// What the format is called.
const FORMAT: &str = "hydrotrace.fleet-notes.v1";

/// Something that was done to a machine.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Note {
    /// Microseconds since 1970.
    pub at_us: i64,
    /// The machine.
    pub machine: String,
    /// The joint, where it was one.
    pub joint: Option<String>,
    /// What was done, in the words of who did it.
    pub what: String,
}

/// All that is noted.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Notes {
    /// Always "hydrotrace.fleet-notes.v1".
    pub format: String,
    /// Name and version of the program that wrote it.
    pub program: String,
    /// In the order of time.
    pub interventions: Vec<Intervention>,
}

/// Something that was done to a machine.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Intervention {
    /// When, UTC.
    pub at: String,
    /// The machine.
    pub machine: String,
    /// The joint, where it was one.
    pub joint: Option<String>,
    /// What was done.
    pub what: String,
}

/// Notes what was done to a machine of the dataset, and gives it as documents have it; the same twice is one note.
///
/// # Errors
///
/// [`FleetFailure`] if there is no dataset or no such machine in it, or it cannot be written.
pub fn note(root: &Path, note: &Note) -> Result<Intervention, FleetFailure> {
    let filter = Filter { machine: Some(note.machine.clone()), ..Filter::default() };
    History::read(root, &filter, false)?;
    let row = vec![
        Cell::from(note.machine.as_str()),
        Cell::Whole(note.at_us),
        Cell::from(note.joint.as_deref()),
        Cell::from(note.what.as_str()),
    ];
    let at = note.at_us.to_string();
    let hash = hash([note.machine.as_str(), &at, note.joint.as_deref().unwrap_or_default(), &note.what]);
    let part = Part { place: place_of(Some(note.at_us), &note.machine), hash };
    let table = Table { columns: Name::Interventions.columns(), rows: vec![row] };
    let file = (part.path(Name::Interventions), table.encode(Name::Interventions.text())?);
    Store::open(root)?.change(&[file], &[])?;
    Ok(note.into())
}

/// All that is noted, or of one machine only, in the order of time.
///
/// # Errors
///
/// [`FleetFailure`] if the dataset cannot be read.
pub fn notes(root: &Path, machine: Option<&str>) -> Result<Vec<Note>, FleetFailure> {
    let mut found = Vec::new();
    for part in parts(root, Name::Interventions)? {
        let path = root.join(part.path(Name::Interventions));
        for row in read_table(&path, &Name::Interventions.columns())?.rows {
            let text = |k: usize| row.get(k).and_then(Cell::as_text).map(str::to_owned);
            let at_us = row.get(1).and_then(Cell::as_whole);
            if let (Some(machine), Some(at_us), Some(what)) = (text(0), at_us, text(3)) {
                found.push(Note { at_us, machine, joint: text(2), what });
            }
        }
    }
    found.retain(|note| machine.is_none_or(|machine| machine == note.machine));
    found.sort();
    Ok(found)
}

/// The effect of what was done last, of the machine or of any; where it was done to one joint, of that one unless the
/// filter names another.
///
/// # Errors
///
/// [`FleetFailure::NoNote`] if nothing is noted; otherwise as [`effect`].
pub fn effect_of_last_note(
    root: &Path,
    machine: Option<&str>,
    filter: &Filter,
    by: &[By],
) -> Result<Effect, FleetFailure> {
    let last = notes(root, machine)?.pop().ok_or_else(|| FleetFailure::NoNote {
        machine: machine.map(str::to_owned),
        dataset: root.to_owned(),
    })?;
    let filter = Filter { joint: filter.joint.clone().or(last.joint), ..filter.clone() };
    Ok(Effect { what: Some(last.what), ..effect(root, &last.machine, last.at_us, &filter, by)? })
}

impl From<&Note> for Intervention {
    fn from(note: &Note) -> Self {
        Self {
            at: date(note.at_us as f64 / 1e6 / SECONDS_PER_DAY).unwrap_or_default(),
            machine: note.machine.clone(),
            joint: note.joint.clone(),
            what: note.what.clone(),
        }
    }
}

impl Notes {
    /// The document of notes.
    pub fn of(notes: &[Note]) -> Self {
        let interventions = notes.iter().map(Intervention::from).collect();
        Self { format: FORMAT.to_owned(), program: PROGRAM.to_owned(), interventions }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::schema::is_written_and_read;

    #[test]
    fn the_committed_schema_is_that_of_the_document_and_what_is_written_is_read_back() {
        let note = |joint: Option<&str>| Note {
            at_us: 1_772_755_200_000_000,
            machine: "M07".into(),
            joint: joint.map(str::to_owned),
            what: "valve replaced".into(),
        };
        let document = Notes::of(&[note(None), note(Some("boom"))]);
        assert_eq!(document.interventions[0].at, "2026-03-06T00:00:00Z");
        is_written_and_read(&document, "fleet-notes.v1.schema.json", "hydrotrace fleet note, version 1");
    }
}
