//! Limits of one joint.

use crate::{arm::Arm, task::Task};

/// Limits of a joint: the tighter of task and arm, infinite where there are none.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct JointLimits {
    /// Lowest and highest angle, rad.
    pub(super) range_rad: [f64; 2],
    /// The same, with both ends where there is one.
    pub(super) judged_rad: [f64; 2],
    /// Lowest speed, below zero, and highest, rad/s; both infinite or neither.
    pub(super) speed_rad_s: [f64; 2],
    pub(super) acceleration_rad_s2: f64,
    pub(super) jerk_rad_s3: f64,
    pub(super) torque_n_m: f64,
    /// Rod speeds while extending and while retracting, m/s.
    pub(super) rod_speed_m_s: [f64; 2],
}

/// A range with one end is taken to end on the other side, too, at so many times the farthest key point's distance from it:
/// no motion goes there.
const ONE_ENDED: f64 = 4.0;

impl JointLimits {
    /// Middle and half the width of the range, rad; `None` without end stops.
    pub(super) fn range(&self) -> Option<(f64, f64)> {
        let [low, high] = self.judged_rad;
        (low.is_finite() && high.is_finite()).then_some((0.5 * (low + high), 0.5 * (high - low)))
    }

    /// Largest speed the way that the sign of `toward` says, rad/s.
    pub(super) fn speed(&self, toward: f64) -> f64 {
        let [low, high] = self.speed_rad_s;
        if toward < 0.0 { -low } else { high }
    }

    /// Lowest and highest acceleration, rad/s².
    pub(super) fn acceleration(&self) -> [f64; 2] {
        [-self.acceleration_rad_s2, self.acceleration_rad_s2]
    }

    /// Lowest and highest jerk, rad/s³.
    pub(super) fn jerk(&self) -> [f64; 2] {
        [-self.jerk_rad_s3, self.jerk_rad_s3]
    }

    /// With the range judged as this joint's key points need it.
    pub(super) fn judged(mut self, key_points_rad: impl Iterator<Item = f64>) -> Self {
        let [low, high] = self.range_rad;
        let end = if low.is_finite() { low } else { high };
        let far = ONE_ENDED * key_points_rad.map(|q| (q - end).abs()).fold(1.0, f64::max);
        self.judged_rad = match (low.is_finite(), high.is_finite()) {
            (true, false) => [low, low + far],
            (false, true) => [high - far, high],
            _ => [low, high],
        };
        self
    }
}

/// Those of a joint of the arm, which is the task's `own`.
pub(super) fn merged(task: &Task, arm: &Arm, joint: usize, own: usize) -> JointLimits {
    let (task, limit) = (&task.limits[own], &arm.chain.joints()[joint].limit);
    let [lower, upper] = task.range_rad.unwrap_or([f64::NEG_INFINITY, f64::INFINITY]);
    let cylinder = arm.hydraulics.cylinders()[joint];
    let rod_speed_m_s = cylinder.map_or([f64::INFINITY; 2], |cylinder| {
        let (push_m2, pull_m2) = (cylinder.push_area_m2(), cylinder.pull_area_m2());
        [push_m2, pull_m2].map(|area_m2| task.rod_speed_m_s.min(arm.hydraulics.pump_flow_m3_s() / area_m2))
    });
    let [low, high] = task.velocity_rad_s;
    let range_rad = [lower.max(limit.lower_rad), upper.min(limit.upper_rad)];
    JointLimits {
        range_rad,
        judged_rad: range_rad,
        speed_rad_s: [low.max(-limit.speed_rad_s), high.min(limit.speed_rad_s)],
        acceleration_rad_s2: task.acceleration_rad_s2,
        jerk_rad_s3: task.jerk_rad_s3,
        torque_n_m: task.torque_n_m.min(limit.torque_nm),
        rod_speed_m_s,
    }
}
