//! Predicted errors of starts, plan by plan and fast.

use super::{
    Model,
    run::{starts, window_end},
    simulate::{Start, simulate},
};

/// The predicted error after a joint is sent off.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PredictedStart {
    /// When, steps of [`STEP_S`](super::STEP_S) since the start.
    pub step: usize,
    /// Whether the joint turns round, and does not leave rest.
    pub reversal: bool,
    /// Largest distance of plan and predicted angle until the next start, for 4 s at most, rad.
    pub peak_error_rad: f64,
}

/// Memory for predictions; reused, it allocates only to grow.
#[derive(Debug, Clone, Default)]
pub struct StartErrorPredictor {
    wanted: Vec<f64>,
    angle_rad: Vec<f64>,
}

impl StartErrorPredictor {
    /// Predicts what a joint makes of `planned`, angle, rad, and speed, rad/s, every
    /// [`STEP_S`](super::STEP_S) from rest on, if it is sent as it is. O(steps).
    pub fn starts(&mut self, model: &Model, planned: &[(f64, f64)]) -> Vec<PredictedStart> {
        simulate(model, planned, Start::at_rest(model, planned), &mut self.wanted, &mut self.angle_rad);
        let at = starts(planned);
        let error = |k: usize| match (planned.get(k), self.angle_rad.get(k)) {
            (Some(planned), Some(angle)) => (planned.0 - angle).abs(),
            _ => 0.0,
        };
        let resting = |step: usize| step == 0 || planned[step - 1].1.abs() < super::run::MOVES_RAD_S;
        at.iter()
            .enumerate()
            .map(|(k, &step)| PredictedStart {
                step,
                reversal: !resting(step),
                peak_error_rad: (step..window_end(&at, k)).map(error).fold(0.0, f64::max),
            })
            .collect()
    }
}
