//! A curve with its values.

use super::{
    aim::Aim,
    curve::{Curve, Frame},
    interior::PRICE,
};
use crate::spline::Motion;

/// The factor of time of a segment that nothing bounds.
const LEAST_FACTOR: f64 = 1e-3;

/// A curve with its values.
pub(super) struct Point {
    pub(super) curve: Curve,
    pub(super) motion: Motion,
    pub(super) duration_s: f64,
    /// Root mean square jerk by joint, rad/s³.
    pub(super) joint_jerk: Vec<f64>,
    /// Their sum, rad/s³.
    pub(super) jerk_rad_s3: f64,
    /// Of the limit that is nearest to being broken, between all instants.
    share: f64,
    merit: f64,
}

impl Point {
    /// Takes a curve at the duration that the aim gives, or each of its segments as fast as the limits allow; angles
    /// stay as they are. `None` if that is no motion.
    pub(super) fn look(frame: &Frame, mut curve: Curve, aim: &Aim) -> Option<Self> {
        let mut motion = frame.motion(&curve).ok()?;
        if aim.within_s.is_finite() {
            let moving_s: f64 = curve.interval_s.iter().sum();
            let by = (aim.within_s - frame.resting_s()) / moving_s;
            for s in &mut curve.interval_s {
                *s *= by;
            }
        } else {
            for (segment, [_, by]) in motion.segments().iter().zip(frame.stretch(&motion)) {
                let (first, last) = segment.ends();
                // Nothing bounds what does not move.
                for s in &mut curve.interval_s[first..last] {
                    *s *= by.max(LEAST_FACTOR);
                }
            }
        }
        frame.clamp(&mut curve.interval_s);
        motion.retime(&frame.times_s(&curve.interval_s)).ok()?;
        let mut joint_jerk = vec![0.0; frame.joints()];
        motion.rms_jerk(&mut joint_jerk);
        let jerk_rad_s3: f64 = joint_jerk.iter().sum();
        let share = frame.stretch(&motion).iter().flatten().fold(0.0, |most: f64, share| most.max(*share));
        let duration_s = motion.duration_s();
        let merit = aim.duration * duration_s.ln() + aim.jerk * jerk_rad_s3.ln();
        merit.is_finite().then_some(Self { curve, motion, duration_s, joint_jerk, jerk_rad_s3, share, merit })
    }

    /// The price of the most broken limit.
    pub(super) fn broken(&self) -> f64 {
        PRICE * (self.share - 1.0).max(0.0)
    }

    /// Merit and penalty.
    pub(super) fn worth(&self) -> f64 {
        self.merit + self.broken()
    }
}
