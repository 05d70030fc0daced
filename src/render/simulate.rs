//! What was simulated.

use std::path::Path;

use super::counted;
use crate::workflow::simulate::log::Run;

/// One line on a run, and one on what to do with it.
pub fn simulated_line(run: &Run, plant: &str, seed: u64, file: &Path) -> String {
    let record = &run.outputs.record;
    let duration_s = record.t_s.last().copied().unwrap_or(0.0);
    let what = if run.commanded { "the command" } else { "the plan" };
    format!(
        "{:.2} s of {} running {what} on the plant {plant}, seed {seed}: {} in {}; the machine's truth is in its metadata.\n\
         hydrotrace report {} says how it followed.\n",
        duration_s,
        counted(record.joints.len(), "joint"),
        counted(record.t_s.len(), "sample"),
        file.display(),
        file.display()
    )
}
