//! The folder that pages are written to. A page appears before the line that says it is there, and both before the rows
//! of the dataset: whatever a kill leaves out is done again.

use std::{
    collections::BTreeMap,
    fs::{self, File},
    io::Write,
    path::{Path, PathBuf},
    thread,
    time::Duration,
};

use super::{
    Index, Words,
    document::{FORMAT, Run, file_name},
    failure::WatchFailure,
};
use crate::{
    atomic_file::write_atomically,
    input_file,
    workflow::fleet::{By, Filter, FleetFailure, Source, drift},
};

/// Where pages lie, below the dataset.
const PAGES: &str = "pages";
const INDEX: &str = "index.html";
const LOCK: &str = ".lock";

/// How long another process may take to replace parts of the dataset.
const A_WHILE: Duration = Duration::from_millis(500);

/// The folder, for this process alone.
#[derive(Debug)]
pub(super) struct Folder {
    root: PathBuf,
    /// What was reported, by log.
    pub(super) runs: BTreeMap<String, Run>,
    /// Held as long as it is watched.
    _lock: File,
}

impl Folder {
    /// Opens it, and reads what was reported before.
    pub(super) fn open(root: &Path) -> Result<Self, WatchFailure> {
        let pages = root.join(PAGES);
        fs::create_dir_all(&pages).map_err(WatchFailure::file("make the folder", &pages))?;
        let path = pages.join(LOCK);
        let lock = File::create(&path).map_err(WatchFailure::file("make", &path))?;
        if matches!(lock.try_lock(), Err(fs::TryLockError::WouldBlock)) {
            return Err(WatchFailure::Locked { path: root.to_owned() });
        }
        let mut runs = BTreeMap::new();
        for entry in fs::read_dir(&pages).map_err(WatchFailure::file("list", &pages))? {
            let path = entry.map_err(WatchFailure::file("list", &pages))?.path();
            if path.extension().is_some_and(|ending| ending == "json") {
                let text = input_file::read_to_string(&path).map_err(WatchFailure::file("read", &path))?;
                // One of another version says nothing: its log is analysed again.
                let run = serde_json::from_str::<Run>(&text).ok().filter(|run| run.format == FORMAT);
                runs.extend(run.map(|run| (run.log.clone(), run)));
            }
        }
        Ok(Self { root: root.to_owned(), runs, _lock: lock })
    }

    /// Where the index is.
    pub(super) fn index(root: &Path) -> PathBuf {
        root.join(INDEX)
    }

    /// Whether a log was reported as it is, for this request.
    pub(super) fn has(&self, source: &Source, request_id: &str) -> bool {
        let page = |run: &Run| run.page.as_ref().is_none_or(|page| self.root.join(page).is_file());
        self.runs
            .get(source.path.to_string_lossy().as_ref())
            .is_some_and(|run| run.log_etag == source.etag && run.request_id == request_id && page(run))
    }

    /// Writes the index of what was reported.
    pub(super) fn write_index(&self, words: &Words<'_>) -> Result<(), WatchFailure> {
        let mut runs: Vec<&Run> = self.runs.values().collect();
        runs.sort_by(|a, b| (&b.started_at, &a.log).cmp(&(&a.started_at, &b.log)));
        let asked = || drift(&self.root, &Filter::default(), &[By::Peak, By::Delay]);
        let again = |error| {
            if matches!(error, FleetFailure::NoDataset { .. }) {
                return Err(error);
            }
            // `fleet compact` replaces parts while they are read.
            thread::sleep(A_WHILE);
            asked()
        };
        let drift = match asked().or_else(again) {
            Err(FleetFailure::NoDataset { .. }) => None,
            found => Some(found?),
        };
        write(&Self::index(&self.root), &(words.index)(&Index { runs, drift }))
    }
}

/// Writes the page of a log; returns its name in the folder.
pub(super) fn write_page(root: &Path, log: &str, text: &str) -> Result<String, WatchFailure> {
    let page = page(log);
    write(&root.join(&page), text)?;
    Ok(page)
}

/// Takes the page of a log away that now fails.
pub(super) fn remove_page(root: &Path, log: &str) -> Result<(), WatchFailure> {
    let path = root.join(page(log));
    match fs::remove_file(&path) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(()),
        removed => removed.map_err(WatchFailure::file("remove", &path)),
    }
}

fn page(log: &str) -> String {
    format!("{PAGES}/{}.html", file_name(log))
}

/// Writes what is said of a log.
pub(super) fn write_run(root: &Path, run: &Run) -> Result<(), WatchFailure> {
    let path = root.join(PAGES).join(file_name(&run.log)).with_extension("json");
    write(&path, &crate::document::pretty(run))
}

fn write(path: &Path, text: &str) -> Result<(), WatchFailure> {
    write_atomically(path, |file| file.write_all(text.as_bytes()).map_err(WatchFailure::file("write", path)))
}
