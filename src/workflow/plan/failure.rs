//! Why there is no plan.

use std::path::PathBuf;

use thiserror::Error;

use crate::{
    arm::ArmError,
    plan::{PlanError, PlanEvaluation},
    task::TaskError,
};

/// Why there is no plan.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum PlanFailure {
    /// A file cannot be read.
    #[error("cannot read {}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A log's task names a file that the log does not hold.
    #[error(
        "the log's task names its arm's file {file:?}, which the log does not hold, and what a log names is not read \
         from elsewhere; plan again, or name the task file with --task where the verb has it"
    )]
    NotCarried {
        /// The file.
        file: String,
    },
    /// The file is no task.
    #[error("{} is no task", path.display())]
    Task {
        /// The file.
        path: PathBuf,
        /// Line and reason.
        source: TaskError,
    },
    /// The task does not fit its arm.
    #[error("{} cannot be planned", path.display())]
    Setup {
        /// The file.
        path: PathBuf,
        /// Why.
        source: Box<PlanError>,
    },
    /// The arm's files.
    #[error("the arm cannot be read")]
    Arm(#[from] ArmError),
    /// Times or settings.
    #[error(transparent)]
    Plan(Box<PlanError>),
    /// No timing keeps all limits; what the nearest one breaks.
    #[error("no plan keeps all limits")]
    Infeasible(Box<PlanEvaluation>),
    /// No plan keeps to the ceilings of the task.
    #[error("no plan keeps to the ceilings of the task")]
    Ceilings {
        /// The nearest, which keeps all other limits.
        nearest: Box<PlanEvaluation>,
    },
}

impl From<PlanError> for PlanFailure {
    fn from(error: PlanError) -> Self {
        Self::Plan(Box::new(error))
    }
}
