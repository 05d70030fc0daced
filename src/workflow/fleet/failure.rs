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
    /// A table of the dataset.
    #[error(transparent)]
    Dataset(#[from] DatasetError),
    /// A file that is written whole or not at all.
    #[error(transparent)]
    Atomic(#[from] AtomicError),
    /// The file system said no.
    #[error("cannot {action} {}", path.display())]
    File { action: &'static str, path: PathBuf, source: std::io::Error },
    /// Another scan writes to the dataset.
    #[error("another scan is writing to {}; wait for its end", path.display())]
    Locked { path: PathBuf },
    /// No dataset.
    #[error("{} holds no dataset; `hydrotrace fleet scan LOGS --into {}` makes one", path.display(), shell_argument(path))]
    NoDataset { path: PathBuf },
    /// A source that leads to no log.
    #[error(
        "found no log in {text:?}, expected a log, a folder with .mcap or .db3 files, a pattern (with **/*.csv at its end for tables) or a list of logs (.txt)"
    )]
    NoLogs { text: String },
    /// A source in an object store.
    #[error(transparent)]
    Remote(#[from] RemoteError),
    /// A table of machines.
    #[error("{} is no table of machines: {reason}; expected the header `path,machine` and a row for each", path.display())]
    Machines { path: PathBuf, reason: String },
    /// Nothing is known of what was done.
    #[error(
        "{} holds no note{}; give --machine and --at, or note what was done: `hydrotrace fleet note {} --machine {} \
         --at 2026-03-06 'valve replaced'`",
        dataset.display(),
        machine.as_ref().map_or(String::new(), |machine| format!(" of {machine}")),
        shell_argument(dataset),
        machine.as_deref().map_or("MACHINE".to_owned(), shell_word)
    )]
    NoNote { machine: Option<String>, dataset: PathBuf },
    /// A note of an instant that is no one's.
    #[error(
        "{at} is more than a year from the nearest run of {machine}, which began {run}; is the date right?"
    )]
    FarNote { machine: String, at: String, run: String },
    /// A note that is to be taken back and is not there.
    #[error(
        "nothing is noted of {machine} at {at} in these words and of this joint; `hydrotrace fleet note {} --machine {}` lists \
         what is",
        shell_argument(dataset),
        shell_word(machine)
    )]
    NotNoted { machine: String, at: String, dataset: PathBuf },
    /// A machine that the dataset does not hold.
    #[error("no machine {machine:?}{}; the dataset has {present}", crate::suggest::suggestion(nearest.as_deref()))]
    NoMachine { machine: String, nearest: Option<String>, present: String },
    /// A joint that the dataset does not hold.
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
