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
#[expect(missing_docs, reason = "the message says what each field is")]
pub enum PlanFailure {
    #[error("cannot read {}", path.display())]
    Read { path: PathBuf, source: std::io::Error },
    #[error(
        "the log's task names its arm's file {file:?}, which the log does not hold, and what a log names is not read \
         from elsewhere; plan again, or name the task file with --task where the verb has it"
    )]
    NotCarried { file: String },
    #[error("{} is no task", path.display())]
    Task { path: PathBuf, source: TaskError },
    #[error("{} cannot be planned", path.display())]
    Setup { path: PathBuf, source: Box<PlanError> },
    #[error("the arm cannot be read")]
    Arm(#[from] ArmError),
    #[error(transparent)]
    Plan(Box<PlanError>),
    /// No timing keeps all limits, and no free shape where one was sought; what the nearest one breaks, what a plan takes that stops at
    /// every key point, if one keeps them, and the longest interval of one that keeps them with intervals longer than the task allows.
    #[error("by times alone no plan keeps all limits")]
    Infeasible { nearest: Box<PlanEvaluation>, stopping_s: Option<f64>, longest_s: Option<f64> },
    #[error("no plan keeps to the ceilings of the task")]
    Ceilings { nearest: Box<PlanEvaluation> },
}

impl From<PlanError> for PlanFailure {
    fn from(error: PlanError) -> Self {
        Self::Plan(Box::new(error))
    }
}
