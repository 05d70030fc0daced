//! Tasks by name.

use std::path::Path;

use super::ContestFailure;
use crate::workflow::plan::PlanRequest;

/// The paper's tasks: name and text.
pub const TASKS: [(&str, &str); 3] = [
    (SIMULATION, include_str!("../../../sample-logs/tasks/simulation.toml")),
    ("task-1", include_str!("../../../sample-logs/tasks/task-1.toml")),
    ("task-2", include_str!("../../../sample-logs/tasks/task-2.toml")),
];

const SIMULATION: &str = "simulation";

/// A task to compare on.
#[derive(Debug, Clone)]
pub struct Subject {
    /// The name it goes by.
    pub name: String,
    /// The task on its arm.
    pub request: PlanRequest,
    /// Whether the paper's Table 3 is of this task.
    pub in_table_3: bool,
}

impl Subject {
    /// A task of [`TASKS`] by name, in any case, or else a task file.
    ///
    /// # Errors
    ///
    /// [`ContestFailure`] if the name is neither, or the task does not fit its arm.
    pub fn find(name: &str) -> Result<Self, ContestFailure> {
        let known = TASKS.into_iter().find(|(known, _)| known.eq_ignore_ascii_case(name));
        let Some((known, text)) = known else { return Self::read(name) };
        let request = PlanRequest::parse(Path::new(known), text.to_owned())?;
        Ok(Self { name: known.to_owned(), request, in_table_3: known == SIMULATION })
    }

    fn read(name: &str) -> Result<Self, ContestFailure> {
        let path = Path::new(name);
        let text = std::fs::read_to_string(path)
            .map_err(|source| ContestFailure::Unknown { name: name.to_owned(), source })?;
        let request = PlanRequest::parse(path, text)?;
        let stem = path.file_stem().map_or(name.to_owned(), |stem| stem.to_string_lossy().into_owned());
        Ok(Self { name: stem, request, in_table_3: false })
    }
}
