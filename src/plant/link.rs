//! Bending between joint and sensor.

use std::f64::consts::TAU;

use super::{Link, STEP_S};

/// How far a link is bent, and how fast.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Bend {
    pub(super) angle_rad: f64,
    speed_rad_s: f64,
    joint_rad_s: f64,
}

impl Bend {
    /// The joint has moved on by a step and turns at a speed, rad/s: what hangs on the spring stays
    /// behind by its inertia.
    pub(super) fn step(&mut self, link: &Link, joint_rad_s: f64) {
        if link.is_rigid() {
            return;
        }
        let own_1_s = TAU * link.frequency_hz;
        let pulled_rad_s2 =
            -own_1_s * (own_1_s * self.angle_rad + 2.0 * link.damping_ratio * self.speed_rad_s);
        self.speed_rad_s += STEP_S * pulled_rad_s2 - (joint_rad_s - self.joint_rad_s);
        self.angle_rad += STEP_S * self.speed_rad_s;
        self.joint_rad_s = joint_rad_s;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_link_swings_at_its_own_frequency_once_its_joint_has_stopped() {
        let link = Link { frequency_hz: 2.0, damping_ratio: 0.02 };
        let mut bend = Bend { joint_rad_s: 0.1, ..Bend::default() };
        let mut signs = Vec::new();
        for _ in 0..30_000 {
            bend.step(&link, 0.0);
            signs.push(bend.angle_rad > 0.0);
        }
        let crossings = signs.windows(2).filter(|pair| pair[0] != pair[1]).count();
        assert!((11..=12).contains(&crossings), "{crossings} in 3 s");
    }
}
