//! `fleet note`: what was done to a machine, and when; `fleet effect` asks what it did.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::{
    arrange::place_of,
    failure::FleetFailure,
    history::{Filter, History},
    run::{Run, date, days},
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

/// An instant farther than this from all runs of the machine is a slip, days.
const FAR_DAYS: f64 = 366.0;

/// Notes what was done to a machine of the dataset, and gives it as documents have it; the same twice is one note.
///
/// # Errors
///
/// [`FleetFailure`] if there is no dataset or no such machine or joint in it, if no run of it is within a year, or it cannot be
/// written.
pub fn note(root: &Path, note: &Note) -> Result<Intervention, FleetFailure> {
    let Note { at_us, machine, joint, what } = note;
    let filter = Filter { machine: Some(machine.clone()), joint: joint.clone(), since_us: None };
    let history = History::read(root, &filter, false)?;
    let apart_days = |run: &Run| (*at_us - run.started_us).abs() as f64 / 1e6 / SECONDS_PER_DAY;
    let runs = || history.runs.iter();
    if let Some(nearest) = runs().min_by(|a, b| apart_days(a).total_cmp(&apart_days(b)))
        && apart_days(nearest) > FAR_DAYS
    {
        let [at, run] = [Intervention::from(note).at, date(days(nearest)).unwrap_or_default()];
        return Err(FleetFailure::FarNote { machine: machine.clone(), at, run });
    }
    let row = vec![
        Cell::from(machine.as_str()),
        Cell::Whole(*at_us),
        Cell::from(joint.as_deref()),
        Cell::from(what.as_str()),
    ];
    let table = Table { columns: Name::Interventions.columns(), rows: vec![row] };
    let file = (note.place(), table.encode(Name::Interventions.text())?);
    Store::open(root)?.change(&[file], &[])?;
    Ok(note.into())
}

/// Takes back what was noted in these words.
///
/// # Errors
///
/// [`FleetFailure`] if nothing is noted so, or it cannot be taken back.
pub fn take_back(root: &Path, note: &Note) -> Result<(), FleetFailure> {
    let place = note.place();
    if !root.join(&place).exists() {
        let (machine, dataset) = (note.machine.clone(), root.to_owned());
        return Err(FleetFailure::NotNoted { machine, at: Intervention::from(note).at, dataset });
    }
    Store::open(root)?.change(&[], &[place])
}

impl Note {
    /// The file of the dataset that holds it and nothing else.
    fn place(&self) -> String {
        let Self { at_us, machine, joint, what } = self;
        let hash = hash([machine.as_str(), &at_us.to_string(), joint.as_deref().unwrap_or_default(), what]);
        Part { place: place_of(Some(*at_us), machine), hash }.path(Name::Interventions)
    }
}

/// All that is noted, or of one machine only, in the order of time.
///
/// # Errors
///
/// [`FleetFailure`] if there is no dataset, or it cannot be read.
pub fn notes(root: &Path, machine: Option<&str>) -> Result<Vec<Note>, FleetFailure> {
    if parts(root, Name::Runs)?.is_empty() {
        return Err(FleetFailure::NoDataset { path: root.to_owned() });
    }
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
