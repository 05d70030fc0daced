//! The triangle through which a cylinder turns its joint: lengths and angles, both ways.

use std::f64::consts::PI;

/// The triangle: two mounts at fixed distances from the joint, the cylinder opposite the joint.
///
/// The angle at the joint is `offset_rad + sense * q`; the length follows from the law of cosines.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Linkage {
    /// From the joint to the mount on the link before it, m.
    pub inner_m: f64,
    /// From the joint to the mount on the link after it, m.
    pub outer_m: f64,
    /// Angle between the mounts, seen from the joint, at joint angle zero, rad.
    pub offset_rad: f64,
    /// 1 where the angle between the mounts grows with the joint's angle, -1 where it shrinks.
    pub sense: f64,
}

impl Linkage {
    /// Length from mount to mount, m, at an angle of the joint, and its change by the angle, m/rad. `None` at a dead centre
    /// and beyond, where no cylinder drives a joint.
    pub fn length_at(&self, angle_rad: f64) -> Option<(f64, f64)> {
        let Self { inner_m: a, outer_m: b, sense, .. } = *self;
        let between_rad = self.offset_rad + sense * angle_rad;
        if !(between_rad > 0.0 && between_rad < PI) {
            return None;
        }
        // The law of cosines by the half angle: nothing cancels where the triangle is flat.
        let length_m = (a - b).hypot(2.0 * (a * b).sqrt() * (0.5 * between_rad).sin());
        Some((length_m, sense * a * b * between_rad.sin() / length_m))
    }

    /// The angle of the joint, rad, at a length from mount to mount, and its change by the length, rad/m. The sides of a
    /// triangle have one angle within 0 and pi, so that there is one. `None` for what is no triangle.
    pub fn angle_at(&self, length_m: f64) -> Option<(f64, f64)> {
        let Self { inner_m: a, outer_m: b, sense, .. } = *self;
        let wide = (length_m - (a - b)) * (length_m + (a - b));
        let narrow = (a + b + length_m) * (a + b - length_m);
        if !(length_m > 0.0 && wide > 0.0 && narrow > 0.0) {
            return None;
        }
        let between_rad = 2.0 * wide.sqrt().atan2(narrow.sqrt());
        Some((sense * (between_rad - self.offset_rad), sense * length_m / (a * b * between_rad.sin())))
    }

    /// The lengths between the dead centres, m.
    pub fn lengths_m(&self) -> [f64; 2] {
        [(self.inner_m - self.outer_m).abs(), self.inner_m + self.outer_m]
    }
}
