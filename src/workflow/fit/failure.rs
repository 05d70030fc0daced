//! Why there is no fit.

use std::path::PathBuf;

use thiserror::Error;

use super::{LIMITS_FORMAT, observe::ObserveFailure};
use crate::fit::FitError;

/// Why there is no fit.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum FitFailure {
    /// A log.
    #[error(transparent)]
    Observe(#[from] ObserveFailure),
    /// The data.
    #[error("the logs cannot be fitted")]
    Fit(#[from] FitError),
    /// A file with limits cannot be read.
    #[error("cannot read {}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A file is no limits.
    #[error("{} does not hold limits; `hydrotrace fit LOG -o FILE` writes some", path.display())]
    Limits {
        /// The file.
        path: PathBuf,
        /// Line and reason.
        source: Box<toml::de::Error>,
    },
    /// A file of another kind or of a later version.
    #[error("{} is of format {found:?}, expected {LIMITS_FORMAT:?}", path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// What it says.
        found: String,
    },
    /// A file of another arm.
    #[error("the limits in {} are of the joints {found}, the log has {expected}: not one in common", path.display())]
    OtherJoints {
        /// The file.
        path: PathBuf,
        /// Its joints.
        found: String,
        /// Those of the log.
        expected: String,
    },
    /// Numbers in a file that no machine has.
    #[error("the limits in {} cannot be used", path.display())]
    Values {
        /// The file.
        path: PathBuf,
        /// Which.
        source: FitError,
    },
}
