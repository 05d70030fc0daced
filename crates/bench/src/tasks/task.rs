//! Tasks by name.

use std::path::Path;

use hydrotrace::{
    plan::PlanError,
    workflow::plan::{PlanFailure, PlanRequest},
};
use moea::MoeaError;
use thiserror::Error;

/// The task that the paper's Table 3 is of.
pub(super) const SIMULATION: &str = include_str!("../../../../sample-logs/tasks/simulation.toml");

/// The paper's tasks: name and text.
const TASKS: [(&str, &str); 3] = [
    ("simulation", SIMULATION),
    ("task-1", include_str!("../../../../sample-logs/tasks/task-1.toml")),
    ("task-2", include_str!("../../../../sample-logs/tasks/task-2.toml")),
];

/// Why nothing was compared.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum TaskFailure {
    /// The name is no task, and no file that can be read.
    #[error("{name} is neither {} nor a task file that can be read", known())]
    Unknown {
        /// What was given.
        name: String,
        /// Why the file cannot be read.
        source: std::io::Error,
    },
    /// The task file cannot be planned.
    #[error(transparent)]
    Task(#[from] PlanFailure),
    /// No timing keeps all limits.
    #[error("{task}: no plan keeps all limits; `hydrotrace plan` says which ones bind")]
    NoPlan {
        /// Name of the task.
        task: String,
    },
    /// Times or settings.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// Settings of an algorithm.
    #[error(transparent)]
    Moea(#[from] MoeaError),
}

fn known() -> String {
    TASKS.map(|(name, _)| name).join(", ")
}

/// Reads one of the paper's tasks by name, in any case, or else a task file; returns its name as well.
///
/// # Errors
///
/// [`TaskFailure`] if the name is neither, or the task does not fit its arm.
pub fn find(name: &str) -> Result<(String, PlanRequest), TaskFailure> {
    if let Some((known, text)) = TASKS.into_iter().find(|(known, _)| known.eq_ignore_ascii_case(name)) {
        return Ok((known.to_owned(), PlanRequest::parse(Path::new(known), text.to_owned())?));
    }
    let path = Path::new(name);
    let text = std::fs::read_to_string(path)
        .map_err(|source| TaskFailure::Unknown { name: name.to_owned(), source })?;
    let stem = path.file_stem().map_or(name.to_owned(), |stem| stem.to_string_lossy().into_owned());
    Ok((stem, PlanRequest::parse(path, text)?))
}
