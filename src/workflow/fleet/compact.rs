//! `fleet compact`: joins the small parts that many scans leave; rows stay as they are.

use std::{collections::BTreeMap, path::Path};

use serde::{Deserialize, Serialize};

use super::{
    arrange::{Gathered, files, gather},
    failure::FleetFailure,
    store::{Part, Place, Store, parts},
    tables::Name,
};
use crate::document::PROGRAM;

/// What the format is called.
const FORMAT: &str = "hydrotrace.fleet-compact.v1";

/// What was joined.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Compacted {
    /// Always "hydrotrace.fleet-compact.v1".
    pub format: String,
    /// Name and version of the program that wrote it.
    pub program: String,
    /// Runs in the dataset.
    pub runs: usize,
    /// Files of all tables before.
    pub files_before: usize,
    /// Files of all tables after.
    pub files_after: usize,
}

/// Joins the parts of each place into one; a process that is killed leaves each row there once.
///
/// # Errors
///
/// [`FleetFailure`] if there is no dataset, or it cannot be read or written.
pub fn compact(root: &Path) -> Result<Compacted, FleetFailure> {
    if parts(root, Name::Runs)?.is_empty() {
        return Err(FleetFailure::NoDataset { path: root.to_owned() });
    }
    let store = Store::open(root)?;
    let files_before = count(root)?;
    let mut places: BTreeMap<Place, Vec<Part>> = BTreeMap::new();
    for part in parts(root, Name::Runs)? {
        places.entry(part.place.clone()).or_default().push(part);
    }
    let mut runs = 0;
    for (place, own) in places {
        let (mut gathered, mut remove) = (Gathered::new(), Vec::new());
        for part in &own {
            remove.extend(gather(root, part, &|_| true, &mut gathered)?);
        }
        runs += gathered.get(&Name::Runs).map_or(0, Vec::len);
        if own.len() > 1 {
            store.change(&files(place, gathered)?, &remove)?;
        }
    }
    let (format, program) = (FORMAT.to_owned(), PROGRAM.to_owned());
    Ok(Compacted { format, program, runs, files_before, files_after: count(root)? })
}

fn count(root: &Path) -> Result<usize, FleetFailure> {
    Name::ALL.into_iter().map(|name| Ok(parts(root, name)?.len())).sum()
}
