//! The files of the dataset: `TABLE/schema=1/date=.../bucket=.../part-HASH.parquet`, changed all at once or not at all.
//!
//! A change is staged in a folder of its own, then said in a journal, then done: files are moved to their places, and
//! those that they replace are removed. Whoever opens the dataset next does what a journal says that was not done; what
//! was staged without a journal is thrown away. So each row is there once, whenever a process is killed.

use std::{
    collections::BTreeSet,
    fs::{self, File},
    io::Write,
    path::{Path, PathBuf},
};

use serde::{Deserialize, Serialize};

use super::{failure::FleetFailure, tables::Name};
use crate::input_file;

const SCHEMA: &str = "schema=1";
const LOCK: &str = ".lock";
const STAGED: &str = ".staged";
const JOURNAL: &str = ".journal.json";
const BEGUN: &str = ".begun.json";

/// Where rows lie: the month of the run, and a sixteenth of the machines. Days would make more files than rows.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Place {
    /// Such as 2026-03; `None` where a log does not tell.
    pub(super) date: Option<String>,
    pub(super) bucket: u8,
}

/// A part of a table.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Part {
    pub(super) place: Place,
    /// The hash of the logs whose rows it holds.
    pub(super) hash: String,
}

/// The dataset, open for changes by this process alone.
#[derive(Debug)]
pub(super) struct Store {
    root: PathBuf,
    /// Held as long as the dataset is open.
    _lock: File,
}

/// A change that is to be done: names of staged files with their places, and files to remove, below the root.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
struct Journal {
    put: Vec<(String, String)>,
    remove: Vec<String>,
}

impl Part {
    /// Its file below the root.
    pub(super) fn path(&self, table: Name) -> String {
        // What engines that read such folders take for no date.
        let date = self.place.date.as_deref().unwrap_or("__HIVE_DEFAULT_PARTITION__");
        let Place { bucket, .. } = self.place;
        format!("{}/{SCHEMA}/date={date}/bucket={bucket}/part-{}.parquet", table.text(), self.hash)
    }
}

/// The parts of a table, in the order of their places.
pub(super) fn parts(root: &Path, table: Name) -> Result<Vec<Part>, FleetFailure> {
    let folder = root.join(table.text()).join(SCHEMA);
    let mut found = Vec::new();
    for (date, dates) in listed(&folder)? {
        let Some(date) = date.strip_prefix("date=") else { continue };
        for (bucket, buckets) in listed(&dates)? {
            let Some(bucket) = bucket.strip_prefix("bucket=").and_then(|text| text.parse().ok()) else {
                continue;
            };
            for (name, _) in listed(&buckets)? {
                let Some(hash) = name.strip_prefix("part-").and_then(|name| name.strip_suffix(".parquet"))
                else {
                    continue;
                };
                let date = Some(date.to_owned()).filter(|date| !date.starts_with("__"));
                found.push(Part { place: Place { date, bucket }, hash: hash.to_owned() });
            }
        }
    }
    found.sort();
    Ok(found)
}

/// Names in a folder with their paths; none if there is no such folder.
fn listed(folder: &Path) -> Result<Vec<(String, PathBuf)>, FleetFailure> {
    let entries = match fs::read_dir(folder) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(Vec::new()),
        entries => entries.map_err(FleetFailure::file("list", folder))?,
    };
    let mut found = Vec::new();
    for entry in entries {
        let entry = entry.map_err(FleetFailure::file("list", folder))?;
        found.push((entry.file_name().to_string_lossy().into_owned(), entry.path()));
    }
    Ok(found)
}

/// Whether a scan was killed before its last change was done; the next one does it.
pub(super) fn is_unfinished(root: &Path) -> bool {
    root.join(JOURNAL).exists()
}

/// The sources of scans that began and did not end: the dataset may lack logs of theirs.
pub(super) fn begun(root: &Path) -> BTreeSet<String> {
    let text = input_file::read_to_string(&root.join(BEGUN)).unwrap_or_default();
    // It appears whole or not at all.
    serde_json::from_str(&text).unwrap_or_default()
}

impl Store {
    /// Opens the dataset in a folder, which is made if it is not there, and does what a killed process left to do.
    pub(super) fn open(root: &Path) -> Result<Self, FleetFailure> {
        fs::create_dir_all(root).map_err(FleetFailure::file("make the folder", root))?;
        let path = root.join(LOCK);
        let lock = File::create(&path).map_err(FleetFailure::file("make", &path))?;
        if matches!(lock.try_lock(), Err(fs::TryLockError::WouldBlock)) {
            return Err(FleetFailure::Locked { path: root.to_owned() });
        }
        let store = Self { root: root.to_owned(), _lock: lock };
        let journal = root.join(JOURNAL);
        if journal.exists() {
            let text = input_file::read_to_string(&journal).map_err(FleetFailure::file("read", &journal))?;
            // It appears whole or not at all; one that says nothing asks for nothing.
            store.done(&serde_json::from_str(&text).unwrap_or_default())?;
        }
        let staged = store.root.join(STAGED);
        if staged.exists() {
            fs::remove_dir_all(&staged).map_err(FleetFailure::file("remove", &staged))?;
        }
        Ok(store)
    }

    pub(super) fn root(&self) -> &Path {
        &self.root
    }

    /// Notes that a scan of these sources begins, until [`Self::end`] takes that back.
    pub(super) fn begin(&self, sources: &[String]) -> Result<(), FleetFailure> {
        let mut begun = begun(&self.root);
        begun.extend(sources.iter().cloned());
        self.note_begun(&begun)
    }

    /// Takes back that a scan of these sources began; those of other scans stay.
    pub(super) fn end(&self, sources: &[String]) -> Result<(), FleetFailure> {
        let mut begun = begun(&self.root);
        begun.retain(|source| !sources.contains(source));
        self.note_begun(&begun)
    }

    fn note_begun(&self, begun: &BTreeSet<String>) -> Result<(), FleetFailure> {
        let path = self.root.join(BEGUN);
        if begun.is_empty() {
            return removed(&path);
        }
        self.put_whole(&path, &serde_json::to_string(begun).unwrap_or_default())
    }

    /// Writes a file that appears whole or not at all.
    fn put_whole(&self, path: &Path, text: &str) -> Result<(), FleetFailure> {
        let staged = self.root.join(STAGED);
        fs::create_dir_all(&staged).map_err(FleetFailure::file("make the folder", &staged))?;
        let before = staged.join("whole");
        write(&before, text.as_bytes())?;
        fs::rename(&before, path).map_err(FleetFailure::file("move", &before))
    }

    /// Puts files in their places and removes others, all or nothing.
    pub(super) fn change(&self, put: &[(String, Vec<u8>)], remove: &[String]) -> Result<(), FleetFailure> {
        let staged = self.root.join(STAGED);
        fs::create_dir_all(&staged).map_err(FleetFailure::file("make the folder", &staged))?;
        let mut journal = Journal::default();
        for (number, (place, bytes)) in put.iter().enumerate() {
            let name = number.to_string();
            write(&staged.join(&name), bytes)?;
            journal.put.push((name, place.clone()));
        }
        let kept = |path: &&String| put.iter().all(|(place, _)| place != *path);
        journal.remove = remove.iter().filter(kept).cloned().collect();
        self.put_whole(&self.root.join(JOURNAL), &serde_json::to_string(&journal).unwrap_or_default())?;
        self.done(&journal)
    }

    fn done(&self, journal: &Journal) -> Result<(), FleetFailure> {
        for (name, place) in &journal.put {
            let (from, to) = (self.root.join(STAGED).join(name), self.root.join(place));
            if let Some(folder) = to.parent() {
                fs::create_dir_all(folder).map_err(FleetFailure::file("make the folder", folder))?;
            }
            match fs::rename(&from, &to) {
                // Moved before the process was killed.
                Err(error) if error.kind() == std::io::ErrorKind::NotFound && to.exists() => {}
                moved => moved.map_err(FleetFailure::file("move", &from))?,
            }
        }
        for place in &journal.remove {
            removed(&self.root.join(place))?;
        }
        let path = self.root.join(JOURNAL);
        fs::remove_file(&path).map_err(FleetFailure::file("remove", &path))
    }
}

/// Removes a file that may be gone.
fn removed(path: &Path) -> Result<(), FleetFailure> {
    match fs::remove_file(path) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(()),
        removed => removed.map_err(FleetFailure::file("remove", path)),
    }
}

/// Writes a file and waits until it is on the disk.
fn write(path: &Path, bytes: &[u8]) -> Result<(), FleetFailure> {
    let mut file = File::create(path).map_err(FleetFailure::file("write", path))?;
    file.write_all(bytes).and_then(|()| file.sync_all()).map_err(FleetFailure::file("write", path))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn part(hash: &str) -> Part {
        Part { place: Place { date: Some("2026-03".into()), bucket: 3 }, hash: hash.into() }
    }

    fn put(hash: &str) -> Vec<(String, Vec<u8>)> {
        vec![(part(hash).path(Name::Runs), hash.as_bytes().to_vec())]
    }

    #[test]
    fn a_change_puts_and_removes_and_leaves_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::open(folder.path()).unwrap();
        store.change(&put("a"), &[]).unwrap();
        store.change(&put("b"), &[part("a").path(Name::Runs)]).unwrap();
        // What is put again is not removed.
        store.change(&put("b"), &[part("b").path(Name::Runs)]).unwrap();
        assert_eq!(parts(folder.path(), Name::Runs).unwrap(), [part("b")]);
        assert_eq!(parts(folder.path(), Name::Joints).unwrap(), []);
        assert!(!is_unfinished(folder.path()));
        let unknown = Part { place: Place { date: None, bucket: 0 }, hash: "c".into() };
        store.change(&[(unknown.path(Name::Runs), Vec::new())], &[]).unwrap();
        assert!(parts(folder.path(), Name::Runs).unwrap().contains(&unknown));
    }

    #[test]
    fn two_scans_do_not_write_at_once() {
        let folder = tempfile::tempdir().unwrap();
        let _first = Store::open(folder.path()).unwrap();
        assert!(matches!(Store::open(folder.path()), Err(FleetFailure::Locked { .. })));
    }

    #[test]
    fn what_a_journal_says_is_done_and_what_none_says_is_thrown_away() {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path();
        Store::open(root).unwrap().change(&put("old"), &[]).unwrap();
        // Killed while staging.
        fs::create_dir_all(root.join(STAGED)).unwrap();
        fs::write(root.join(STAGED).join("0"), "half").unwrap();
        drop(Store::open(root).unwrap());
        assert_eq!(parts(root, Name::Runs).unwrap(), [part("old")]);
        // Killed after the journal, before, between and behind the two steps.
        for done in 0..3 {
            fs::create_dir_all(root.join(STAGED)).unwrap();
            let (old, new) = (part("old").path(Name::Runs), part("new").path(Name::Runs));
            fs::write(root.join(&old), "old").unwrap();
            let staged = root.join(STAGED).join("0");
            fs::write(if done > 0 { root.join(&new) } else { staged }, "new").unwrap();
            if done > 1 {
                fs::remove_file(root.join(&old)).unwrap();
            }
            let journal = Journal { put: vec![("0".into(), new)], remove: vec![old] };
            fs::write(root.join(JOURNAL), serde_json::to_string(&journal).unwrap()).unwrap();
            assert!(is_unfinished(root));
            drop(Store::open(root).unwrap());
            assert_eq!(parts(root, Name::Runs).unwrap(), [part("new")], "{done}");
            fs::remove_file(root.join(part("new").path(Name::Runs))).unwrap();
        }
    }
}
