//! Why there is no fit.

use std::path::PathBuf;

use thiserror::Error;

use super::{LIMITS_FORMAT, observe::ObserveFailure};
use crate::fit::FitError;

/// Why there is no fit.
#[derive(Debug, Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the message says what each field is")]
pub enum FitFailure {
    #[error(transparent)]
    Observe(#[from] ObserveFailure),
    #[error("the logs cannot be fitted")]
    Fit(#[from] FitError),
    #[error("cannot read {}", path.display())]
    Read { path: PathBuf, source: std::io::Error },
    /// The document of a fit, for programs.
    #[error(
        "{} is JSON, the document of a fit; limits are TOML: give -o of `hydrotrace fit` a name that ends in .toml, and that file \
         here",
        path.display()
    )]
    Document { path: PathBuf },
    #[error("{} does not hold limits; `hydrotrace fit LOG -o FILE` writes some", path.display())]
    Limits { path: PathBuf, source: Box<toml::de::Error> },
    #[error("{} is of format {found:?}, expected {LIMITS_FORMAT:?}", path.display())]
    Format { path: PathBuf, found: String },
    #[error("the limits in {} are of the joints {found}, the log has {expected}: not one in common", path.display())]
    OtherJoints { path: PathBuf, found: String, expected: String },
    #[error(
        "{joint} turns in one of the log and {}, and slides in the other: fit a log of lengths for lengths, of angles for angles \
         (--slides, --hydraulics with --as)",
        path.display()
    )]
    OtherKind { path: PathBuf, joint: String },
    #[error("the limits in {} cannot be used", path.display())]
    Values { path: PathBuf, source: FitError },
}
