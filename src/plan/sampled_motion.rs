//! The motion of a plan, sampled for plots.

use super::{PlanError, PlanEvaluation, Setup};
use crate::spline::{Quantity, Samples};

/// Angles and speeds of all joints over a plan.
#[derive(Debug, Clone, PartialEq)]
pub struct SampledMotion {
    /// Instants, s, `[n]`.
    pub t_s: Vec<f64>,
    /// Angles, rad, `[joints][n]`.
    pub position_rad: Vec<Vec<f64>>,
    /// Speeds, rad/s, `[joints][n]`.
    pub velocity_rad_s: Vec<Vec<f64>>,
    /// Arrivals at the key points, s.
    pub arrivals_s: Vec<f64>,
}

/// Instants of a course, less one.
const STEPS: u32 = 600;

impl SampledMotion {
    /// Of a plan on its arm.
    ///
    /// # Errors
    ///
    /// [`PlanError`] if the times are not those of the task.
    pub fn of(setup: &Setup, evaluation: &PlanEvaluation) -> Result<Self, PlanError> {
        let motion = setup.motion_through(&evaluation.times_s, &evaluation.via)?;
        let t_s: Vec<f64> =
            (0..=STEPS).map(|i| motion.duration_s() * f64::from(i) / f64::from(STEPS)).collect();
        let mut samples = Samples::default();
        motion.sample(&t_s, Quantity::Velocity, &mut samples);
        let of = |quantity| (0..motion.joints()).map(|joint| samples.of(quantity, joint).to_vec()).collect();
        Ok(Self {
            position_rad: of(Quantity::Position),
            velocity_rad_s: of(Quantity::Velocity),
            arrivals_s: evaluation.times_s.clone(),
            t_s,
        })
    }
}
