//! The machine that the runs are of.

use std::path::PathBuf;

use super::{
    super::fit::{self, LimitsFile, observation},
    Inputs, ReplanFailure,
};
use crate::{
    fit::{Fit, Observation},
    log::Recording,
    remark::Remarks,
};

/// What runs that a model was fitted to, among others, leave unexplained is less than what the next one will.
const SEEN: f64 = 1.25;

/// The machine: fitted, or from a file; with the names of the logs behind it.
pub(super) fn machine(
    inputs: &Inputs,
    logs: &[PathBuf],
    observed: &[&Recording],
) -> Result<(Fit, Vec<String>, Remarks), ReplanFailure> {
    if let Some(path) = &inputs.limits {
        let file = LimitsFile::read(path)?;
        let joints =
            observed.iter().flat_map(|run| &run.measured.tracks).map(|track| (track.name(), track.kind()));
        file.check_joints(path, joints)?;
        let own =
            |log: &String| logs.iter().any(|path| path.file_name().is_some_and(|name| name == log.as_str()));
        let doubts = fit::doubts(logs, observed);
        if file.logs.iter().all(own) {
            return Ok((file.fit, file.logs, doubts));
        }
        // What the models leave unexplained elsewhere, as in strokes of an identification run, is not what they leave here.
        let seen: Vec<Observation<'_>> = observed.iter().map(|run| observation(run)).collect();
        let factor = if file.logs.iter().any(own) { SEEN } else { 1.0 };
        return Ok((file.fit.held_against(&seen, factor), file.logs, doubts));
    }
    let fitted = fit::of(logs, observed).map_err(fit::FitFailure::from)?;
    Ok((fitted.fit, fitted.runs.into_iter().map(|run| run.log).collect(), fitted.remarks))
}
