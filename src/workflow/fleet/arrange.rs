//! Where the rows of a run lie in the dataset, and in which order.

use std::{collections::BTreeMap, path::Path};

use chrono::DateTime;

use super::{
    failure::FleetFailure,
    store::{Part, Place},
    tables::Name,
};
use crate::{
    log::dataset::{Cell, Table, read_table},
    workflow::report::hash,
};

/// Buckets of machines.
const BUCKETS: u64 = 16;

/// Rows of one place, by table.
pub(super) type Gathered = BTreeMap<Name, Vec<Vec<Cell>>>;

fn at(name: Name, column: &str) -> usize {
    name.columns().iter().position(|known| known.name == column).unwrap_or(0)
}

/// The place of a run's rows.
pub(super) fn place(run: &[Cell]) -> Place {
    let of = |column: &str| run.get(at(Name::Runs, column));
    let machine = of("machine").and_then(Cell::as_text).unwrap_or_default();
    place_of(of("started_at").and_then(Cell::as_whole), machine)
}

/// The place of rows of a machine at an instant, microseconds since 1970.
pub(super) fn place_of(at_us: Option<i64>, machine: &str) -> Place {
    let at = at_us.and_then(DateTime::from_timestamp_micros);
    let digits = u64::from_str_radix(&hash([machine]), 16).unwrap_or(0);
    let bucket = u8::try_from(digits % BUCKETS).unwrap_or(0);
    Place { date: at.map(|at| at.format("%Y-%m").to_string()), bucket }
}

/// Adds the rows of a part that are to stay; returns its files, below the root.
pub(super) fn gather(
    root: &Path,
    part: &Part,
    stays: &dyn Fn(&Vec<Cell>) -> bool,
    into: &mut Gathered,
) -> Result<Vec<String>, FleetFailure> {
    let mut found = Vec::new();
    for name in Name::ALL {
        let path = part.path(name);
        if root.join(&path).exists() {
            let rows = read_table(&root.join(&path), &name.columns())?.rows;
            into.entry(name).or_default().extend(rows.into_iter().filter(stays));
            found.push(path);
        }
    }
    Ok(found)
}

/// The files of one part with these rows: names below the root, and bytes. Equal rows give equal files.
pub(super) fn files(place: Place, gathered: Gathered) -> Result<Vec<(String, Vec<u8>)>, FleetFailure> {
    let Some(runs) = gathered.get(&Name::Runs).filter(|runs| !runs.is_empty()) else { return Ok(Vec::new()) };
    let part = Part { place, hash: inputs_hash(runs) };
    let mut files = Vec::new();
    for (name, mut rows) in gathered {
        if rows.is_empty() {
            continue;
        }
        sort(name, &mut rows);
        let table = Table { columns: name.columns(), rows };
        files.push((part.path(name), table.encode(name.text())?));
    }
    Ok(files)
}

/// The hash of the logs of a part: their names, states and analyses.
fn inputs_hash(runs: &[Vec<Cell>]) -> String {
    let places = ["log_uri", "log_etag", "analysis_id"].map(|column| at(Name::Runs, column));
    let key =
        |run: &Vec<Cell>| places.map(|k| run.get(k).and_then(Cell::as_text).unwrap_or_default().to_owned());
    let mut keys: Vec<[String; 3]> = runs.iter().map(key).collect();
    keys.sort_unstable();
    hash(keys.iter().flatten())
}

/// Sorts rows by machine, joint and place among the starts, then by run.
fn sort(name: Name, rows: &mut [Vec<Cell>]) {
    let texts = ["machine", "joint"].map(|column| at(name, column));
    let index = at(name, "event_index");
    rows.sort_by_cached_key(|row| {
        let text = |k: usize| row.get(k).and_then(Cell::as_text).unwrap_or_default().to_owned();
        let number = row.get(index).and_then(Cell::as_whole).unwrap_or(0);
        (texts.map(text), number, text(0))
    });
}
