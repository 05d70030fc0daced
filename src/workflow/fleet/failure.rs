//! Why there is nothing to say of a fleet.

use std::path::PathBuf;

use thiserror::Error;

use crate::{
    atomic_file::AtomicError,
    log::{dataset::DatasetError, remote::RemoteError},
    text::{shell_argument, shell_word},
};

/// Why a scan or an answer failed. A log that cannot be read is no failure: it is a row with its error.
#[derive(Debug, Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the message says what each field is")]
pub enum FleetFailure {
    #[error(transparent)]
    Dataset(#[from] DatasetError),
    #[error(transparent)]
    Atomic(#[from] AtomicError),
    #[error("cannot {action} {}", path.display())]
    File { action: &'static str, path: PathBuf, source: std::io::Error },
    #[error("another scan is writing to {}; wait for its end", path.display())]
    Locked { path: PathBuf },
    #[error("{} holds no dataset; `hydrotrace fleet scan LOGS --into {}` makes one", path.display(), shell_argument(path))]
    NoDataset { path: PathBuf },
    #[error(
        "found no log in {text:?}, expected a log, a folder with .mcap or .db3 files, a pattern (with **/*.csv at its end for tables) or a list of logs (.txt)"
    )]
    NoLogs { text: String },
    #[error(transparent)]
    Remote(#[from] RemoteError),
    #[error("{} is no table of machines: {reason}; expected the header `path,machine` and a row for each", path.display())]
    Machines { path: PathBuf, reason: String },
    #[error(
        "{} holds no note{}; give --machine and --at, or note what was done: `hydrotrace fleet note {} --machine {} \
         --at 2026-03-06 'valve replaced'`",
        dataset.display(),
        machine.as_ref().map_or(String::new(), |machine| format!(" of {machine}")),
        shell_argument(dataset),
        machine.as_deref().map_or("MACHINE".to_owned(), shell_word)
    )]
    NoNote { machine: Option<String>, dataset: PathBuf },
    #[error(
        "{at} is more than a year from the nearest run of {machine}, which began {run}; is the date right?"
    )]
    FarNote { machine: String, at: String, run: String },
    #[error(
        "nothing is noted of {machine} at {at} in these words and of this joint; `hydrotrace fleet note {} --machine {}` lists \
         what is",
        shell_argument(dataset),
        shell_word(machine)
    )]
    NotNoted { machine: String, at: String, dataset: PathBuf },
    #[error("no machine {machine:?}{}; the dataset has {present}", crate::suggest::suggestion(nearest.as_deref()))]
    NoMachine { machine: String, nearest: Option<String>, present: String },
    #[error("no joint {joint:?}{}; the dataset has {present}", crate::suggest::suggestion(nearest.as_deref()))]
    NoJoint { joint: String, nearest: Option<String>, present: String },
}

impl FleetFailure {
    /// Wraps an I/O failure; use with `map_err`.
    pub(super) fn file(action: &'static str, path: &std::path::Path) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.to_owned();
        move |source| Self::File { action, path, source }
    }
}
