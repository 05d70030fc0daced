//! What was written, and what to do with it.

use std::path::Path;

/// After `plan`.
pub fn plan_written(log: &Path) -> String {
    let log = log.display();
    format!("Written to {log}; hydrotrace simulate {log} -o run.mcap runs it on a simulated machine.")
}

/// After `fit` of these logs.
pub fn limits_written(limits: &Path, logs: &[impl AsRef<Path>]) -> String {
    let limits = limits.display();
    let last = logs.last().map_or("LOG".into(), |log| log.as_ref().display().to_string());
    format!(
        "Written to {limits}; hydrotrace replan {last} --limits {limits} -o next.mcap plans the next run by it."
    )
}

/// After `replan` of these logs.
pub fn next_written(next: &Path, logs: &[impl AsRef<Path>]) -> String {
    let next = next.display();
    let last = logs.last().map_or("LOG".into(), |log| log.as_ref().display().to_string());
    format!(
        "Written to {next}. After the run, hydrotrace join RUN.mcap --plan {next} -o after.mcap puts its plan into the \
         recorder's log, and hydrotrace compare {last} after.mcap tells whether it helped."
    )
}
