//! Why a folder is not watched.

use std::path::{Path, PathBuf};

use thiserror::Error;

use crate::{atomic_file::AtomicError, workflow::fleet::FleetFailure};

/// Why watching ended. A log that cannot be analysed is no failure: it is a run with its error.
#[derive(Debug, Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the message says what each field is")]
pub enum WatchFailure {
    #[error(
        "{} holds the logs that are watched, and the reports would lie among them; give --into a folder of its own, inside it or \
         elsewhere",
        path.display()
    )]
    Itself { path: PathBuf },
    #[error(transparent)]
    Fleet(#[from] FleetFailure),
    #[error(transparent)]
    Atomic(#[from] AtomicError),
    #[error("cannot {action} {}", path.display())]
    File { action: &'static str, path: PathBuf, source: std::io::Error },
    #[error("another `hydrotrace watch` is writing to {}; give this one another folder with --into", path.display())]
    Locked { path: PathBuf },
}

impl WatchFailure {
    /// Wraps an I/O failure; use with `map_err`.
    pub(super) fn file(action: &'static str, path: &Path) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.to_owned();
        move |source| Self::File { action, path, source }
    }
}
