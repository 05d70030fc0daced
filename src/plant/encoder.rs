//! What loop and log see of a joint's angle.

use super::{Encoder, STEP_S};

#[derive(Debug, Clone, Copy)]
pub(super) struct Sensor {
    /// Angle behind the backlash, rad.
    pub(super) seen_rad: f64,
    /// Its speed over the last step, rad/s.
    pub(super) seen_rad_s: f64,
    /// The last reading, rad.
    read_rad: f64,
    /// Smoothed differences of readings, rad/s.
    pub(super) driver_rad_s: f64,
}

impl Sensor {
    /// At rest in the middle of the backlash, read exactly.
    pub(super) fn new(angle_rad: f64) -> Self {
        Self { seen_rad: angle_rad, seen_rad_s: 0.0, read_rad: angle_rad, driver_rad_s: 0.0 }
    }

    /// The joint has moved on by a step.
    pub(super) fn step(&mut self, encoder: &Encoder, angle_rad: f64) {
        let half_rad = 0.5 * encoder.backlash_rad;
        let seen_rad = self.seen_rad.max(angle_rad - half_rad).min(angle_rad + half_rad);
        self.seen_rad_s = (seen_rad - self.seen_rad) / STEP_S;
        self.seen_rad = seen_rad;
    }

    /// A reading some time from now with `noise` standard deviations of noise, rad.
    pub(super) fn reading_rad(&self, encoder: &Encoder, ahead_s: f64, noise: f64) -> f64 {
        let noisy_rad = self.ahead_rad(ahead_s) + noise * encoder.noise_rad;
        (noisy_rad / encoder.count_rad).round() * encoder.count_rad
    }

    /// The angle some time from now, a few steps at most, rad.
    pub(super) fn ahead_rad(&self, ahead_s: f64) -> f64 {
        self.seen_rad + ahead_s * self.seen_rad_s
    }

    /// The driver takes a reading, rad, and works out a speed.
    pub(super) fn take(&mut self, read_rad: f64, period_s: f64, filter_s: f64) {
        let rough_rad_s = (read_rad - self.read_rad) / period_s;
        self.driver_rad_s += period_s / (period_s + filter_s) * (rough_rad_s - self.driver_rad_s);
        self.read_rad = read_rad;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ENCODER: Encoder = Encoder { backlash_rad: 0.01, noise_rad: 0.0, count_rad: 0.001 };

    #[test]
    fn a_reversal_is_seen_once_the_joint_has_crossed_the_backlash() {
        let mut sensor = Sensor::new(0.0);
        for angle_rad in [0.1, 0.2, 0.191] {
            sensor.step(&ENCODER, angle_rad);
        }
        assert!((sensor.seen_rad - 0.195).abs() < 1e-12);
        sensor.step(&ENCODER, 0.18);
        assert!((sensor.seen_rad - 0.185).abs() < 1e-12);
    }

    #[test]
    fn readings_are_counts() {
        assert!((Sensor::new(0.01234).reading_rad(&ENCODER, 0.0, 0.0) - 0.012).abs() < 1e-12);
    }
}
