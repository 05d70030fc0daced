//! Why there is no report.

use std::path::PathBuf;

use thiserror::Error;

use crate::{arm::ArmError, log::LogError};

/// Why there is no report.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ReportFailure {
    /// The log cannot be read, or holds no planned and measured joints.
    #[error(transparent)]
    Log(#[from] LogError),
    /// The URDF that was given cannot be read.
    #[error("cannot read {}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The URDF or the tool that was given makes no arm.
    #[error("the tool cannot be placed")]
    Arm(#[source] Box<ArmError>),
}
