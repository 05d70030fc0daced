//! What came of what was sent, joint by joint.

use super::{
    super::{model::STEP_S, run::sampled},
    Trial,
};
use crate::series::Track;

/// What was sent to one joint and what came of it, every [`STEP_S`].
pub(super) struct Answer {
    pub(super) sent: Vec<(f64, f64)>,
    pub(super) measured_rad: Vec<f64>,
}

impl Answer {
    pub(super) fn of(trial: &Trial, name: &str, from_s: f64, steps: usize) -> Option<Self> {
        let at = |track: &Track, k: usize| track.held_at(from_s + k as f64 * STEP_S);
        let (sent, measured) = (trial.sent.track(name)?, trial.measured.track(name)?);
        Some(Self {
            sent: sampled(sent, from_s, steps),
            measured_rad: (0..steps).map(|k| at(measured, k).position).collect(),
        })
    }

    pub(super) fn error_rad(&self, planned: &[(f64, f64)]) -> Vec<f64> {
        planned.iter().zip(&self.measured_rad).map(|(planned, measured)| planned.0 - measured).collect()
    }

    pub(super) fn correction_rad(&self, planned: &[(f64, f64)]) -> Vec<f64> {
        planned.iter().zip(&self.sent).map(|(planned, sent)| sent.0 - planned.0).collect()
    }
}
