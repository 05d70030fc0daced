//! Prediction beside measurement where the model was not fitted to it.

use super::{model::STEP_S, run::Run, skill::HeldOutStart};

/// A stretch of a log, predicted by fits to other parts of the data. Errors are sent minus measured or predicted.
#[derive(Debug, Clone, PartialEq)]
pub struct HeldOut {
    /// The joint.
    pub joint: String,
    /// Which of the logs, from 0.
    pub log: usize,
    /// Instants, s since the start of the log; arrays are `[n]`.
    pub t_s: Vec<f64>,
    /// Measured error, rad.
    pub measured_rad: Vec<f64>,
    /// Predicted error, rad.
    pub predicted_rad: Vec<f64>,
    /// Measured and predicted peak after each start, rad.
    pub peaks_rad: Vec<[f64; 2]>,
}

impl HeldOut {
    pub(super) fn of(joint: &str, run: &Run, errors: &[(f64, f64)], starts: &[HeldOutStart]) -> Self {
        let instant = |sample: &super::run::Sample| run.from_s + (sample.step as f64 + sample.part) * STEP_S;
        Self {
            joint: joint.to_owned(),
            log: run.log,
            t_s: run.samples.iter().map(instant).collect(),
            measured_rad: errors.iter().map(|error| error.0).collect(),
            predicted_rad: errors.iter().map(|error| error.1).collect(),
            peaks_rad: starts.iter().map(HeldOutStart::peaks_rad).collect(),
        }
    }
}
