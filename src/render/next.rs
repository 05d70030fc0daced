//! What was written, and what to do with it.

use std::path::Path;

use super::kit::{Id, Section, Sentence};

fn next(text: String) -> Section {
    Section::plain(Id::NEXT, [Sentence::Advice(text)])
}

/// After `plan`.
pub fn plan_written(log: &Path) -> Section {
    let log = log.display();
    next(format!("Written to {log}; hydrotrace simulate {log} -o run.mcap runs it on a simulated machine."))
}

/// After `fit` of these logs.
pub fn limits_written(limits: &Path, logs: &[impl AsRef<Path>]) -> Section {
    let limits = limits.display();
    let last = logs.last().map_or("LOG".into(), |log| log.as_ref().display().to_string());
    next(format!(
        "Written to {limits}; hydrotrace replan {last} --limits {limits} -o next.mcap plans the next run by it."
    ))
}

/// After `replan` of these logs.
pub fn next_written(next_log: &Path, logs: &[impl AsRef<Path>]) -> Section {
    let log = next_log.display();
    let last = logs.last().map_or("LOG".into(), |log| log.as_ref().display().to_string());
    next(format!(
        "Written to {log}. After the run, hydrotrace join RUN.mcap --plan {log} -o after.mcap puts its plan into the \
         recorder's log, and hydrotrace compare {last} after.mcap tells whether it helped."
    ))
}
