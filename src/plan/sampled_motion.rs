//! The motion of a plan, sampled for plots.

use super::{PlanError, PlanEvaluation, Setup};
use crate::{
    series::JointKind,
    spline::{Motion, Quantity, Samples},
};

/// Angles and speeds of all joints over a plan, the way of the tool, and what limits them.
#[derive(Debug, Clone, PartialEq)]
pub struct SampledMotion {
    /// Instants, s, `[n]`.
    pub t_s: Vec<f64>,
    /// How the joints move: of those that slide read m for rad.
    pub kinds: Vec<JointKind>,
    /// Angles, rad, `[joints][n]`.
    pub position_rad: Vec<Vec<f64>>,
    /// Speeds, rad/s, `[joints][n]`.
    pub velocity_rad_s: Vec<Vec<f64>>,
    /// Places of the tool in the base's frame, m, `[n]`.
    pub tool_m: Vec<[f64; 3]>,
    /// Speeds of the tool, m/s, `[n]`.
    pub tool_speed_m_s: Vec<f64>,
    /// Arrivals at the key points, s.
    pub arrivals_s: Vec<f64>,
    /// Angles at the key points, rad, `[joints][points]`.
    pub key_points_rad: Vec<Vec<f64>>,
    /// Lowest and highest angle of each joint, rad; infinite where there is none.
    pub range_rad: Vec<[f64; 2]>,
    /// Lowest and highest speed of each joint, rad/s; infinite where there is none.
    pub speed_limit_rad_s: Vec<[f64; 2]>,
}

impl SampledMotion {
    /// Of a plan on its arm, at `steps` instants and one, at least two.
    ///
    /// # Errors
    ///
    /// [`PlanError`] if the times are not those of the task.
    pub fn of(setup: &Setup, evaluation: &PlanEvaluation, steps: u32) -> Result<Self, PlanError> {
        let motion = setup.motion_through(&evaluation.times_s, &evaluation.via)?;
        let steps = steps.max(1);
        let t_s: Vec<f64> =
            (0..=steps).map(|i| motion.duration_s() * f64::from(i) / f64::from(steps)).collect();
        let [position_rad, velocity_rad_s] = sampled(&motion, &t_s);
        let [key_points_rad, _] = sampled(&motion, &evaluation.times_s);
        let at = |i: usize, of: &[Vec<f64>]| of.iter().map(|joint| joint[i]).collect::<Vec<f64>>();
        let chain = &setup.arm().chain;
        let place = |i: usize| chain.tool_pose(&at(i, &position_rad)).translation.vector.into();
        let speed = |i: usize| chain.tool_speed_m_s(&at(i, &position_rad), &at(i, &velocity_rad_s));
        Ok(Self {
            tool_m: (0..t_s.len()).map(place).collect(),
            tool_speed_m_s: (0..t_s.len()).map(speed).collect(),
            kinds: setup.joint_kinds().collect(),
            arrivals_s: evaluation.times_s.clone(),
            key_points_rad,
            range_rad: setup.limits.iter().map(|limits| limits.range_rad).collect(),
            speed_limit_rad_s: setup.limits.iter().map(|limits| limits.speed_rad_s).collect(),
            position_rad,
            velocity_rad_s,
            t_s,
        })
    }
}

/// Angles and speeds, `[joints][n]`.
fn sampled(motion: &Motion, t_s: &[f64]) -> [Vec<Vec<f64>>; 2] {
    let mut samples = Samples::default();
    motion.sample(t_s, Quantity::Velocity, &mut samples);
    let of = |quantity| (0..motion.joints()).map(|joint| samples.of(quantity, joint).to_vec()).collect();
    [of(Quantity::Position), of(Quantity::Velocity)]
}
