//! A curve of free shape, and what is given of it.

use crate::{
    arm::Pose,
    plan::Setup,
    spline::{Degree, Dwell, KeyPoints, Motion, Quantity, Segment, SplineError},
};

/// Share of a range that descents keep to: rounding beyond its end could not be mended by more time.
const WITHIN: f64 = 1.0 - 1e-6;

/// Limits of a joint that a descent keeps; infinite where there are none.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Bounds {
    /// Lowest and highest angle, rad, speed, rad/s, acceleration, rad/s², and jerk, rad/s³.
    pub(super) limits: [[f64; 2]; 4],
}

impl Bounds {
    /// Middle and half the width of what is allowed of the angle's derivative of an order, if it is bounded.
    pub(super) fn of(&self, order: usize) -> Option<(f64, f64)> {
        let [low, high] = *self.limits.get(order)?;
        let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
        let half = if order == 0 { half * WITHIN } else { half };
        (middle.is_finite() && half.is_finite()).then_some((middle, half))
    }
}

/// What is given of a curve. Its points are the key points and free points between them.
#[derive(Debug, Clone)]
pub(super) struct Frame<'a> {
    pub(super) setup: &'a Setup,
    /// By point, not by key point.
    pub(super) dwells: Vec<Dwell>,
    /// Points that are key points, ascending, first and last among them.
    pub(super) key: Vec<usize>,
    /// By joint.
    pub(super) bounds: Vec<Bounds>,
    /// Points among the key points at which the tool is given and the joints are free.
    pub(super) poses: Vec<(usize, Pose)>,
}

/// A curve in a frame.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Curve {
    /// Time of movement from each point to the next, s.
    pub(super) interval_s: Vec<f64>,
    /// Angles, `[point][joint]`, rad.
    pub(super) point_rad: Vec<f64>,
}

impl Frame<'_> {
    pub(super) fn joints(&self) -> usize {
        self.bounds.len()
    }

    /// Whether the angles at a point are given.
    pub(super) fn is_given(&self, point: usize) -> bool {
        self.key.binary_search(&point).is_ok() && self.pose(point).is_none()
    }

    /// Where the tool is at a point whose joints are free.
    pub(super) fn pose(&self, point: usize) -> Option<&Pose> {
        self.poses.iter().find(|(own, _)| *own == point).map(|(_, pose)| pose)
    }

    pub(super) fn degree(&self) -> Degree {
        self.setup.template.degree()
    }

    /// Arrival at every point, s.
    pub(super) fn times_s(&self, interval_s: &[f64]) -> Vec<f64> {
        let mut t_s = vec![0.0];
        let mut now_s = 0.0;
        for (i, interval_s) in interval_s.iter().enumerate() {
            let dwell = self.dwells.iter().find(|dwell| dwell.point == i);
            now_s += dwell.map_or(0.0, |dwell| dwell.length_s) + interval_s;
            t_s.push(now_s);
        }
        t_s
    }

    /// Sum of the dwells, s.
    pub(super) fn resting_s(&self) -> f64 {
        self.dwells.iter().map(|dwell| dwell.length_s).sum()
    }

    /// # Errors
    ///
    /// [`SplineError`] if the points and times make no motion.
    pub(super) fn motion(&self, curve: &Curve) -> Result<Motion, SplineError> {
        let points = KeyPoints::new(self.joints(), curve.point_rad.clone())?;
        Motion::new(self.degree(), points, &self.setup.ends, &self.dwells, &self.times_s(&curve.interval_s))
    }

    /// Brings the time of movement between every two key points within its bounds.
    pub(super) fn clamp(&self, interval_s: &mut [f64]) {
        let [low, high] = self.setup.interval_s;
        for ends in self.key.windows(2) {
            let own = &mut interval_s[ends[0]..ends[1]];
            let whole: f64 = own.iter().sum();
            let by = whole.clamp(low, high) / whole;
            for s in own {
                *s *= by;
            }
        }
    }

    /// By segment, from exact extrema: the largest share of a joint's range, and the factor of time at which the
    /// largest of speeds, accelerations and jerks is at its limit.
    pub(super) fn stretch(&self, motion: &Motion) -> Vec<[f64; 2]> {
        let of = |segment: &Segment| {
            let mut found = [0.0_f64; 2];
            for (joint, bounds) in self.bounds.iter().enumerate() {
                for (order, quantity) in Quantity::ALL.into_iter().enumerate() {
                    let Some((middle, half)) = bounds.of(order) else { continue };
                    let at = segment.spline.extrema(joint, quantity);
                    let (least, greatest) = (at.least.value, at.greatest.value);
                    if order == 0 {
                        found[0] = found[0].max((greatest - middle).max(middle - least) / half);
                    } else {
                        // Time divides a rate itself, and not its distance from the middle.
                        let share = (greatest / (middle + half)).max(least / (middle - half));
                        found[1] = found[1].max(share.powf(1.0 / order as f64));
                    }
                }
            }
            found
        };
        motion.segments().iter().map(of).collect()
    }

    /// The same curve with free points that split every interval into so many equal pieces, and its frame.
    ///
    /// # Errors
    ///
    /// [`SplineError`] if the curve is no motion.
    pub(super) fn refined(&self, curve: &Curve, pieces: usize) -> Result<(Self, Curve), SplineError> {
        let motion = self.motion(curve)?;
        let mut frame = self.clone();
        for point in &mut frame.key {
            *point *= pieces;
        }
        frame.poses.iter_mut().for_each(|(point, _)| *point *= pieces);
        frame.dwells.iter_mut().for_each(|dwell| dwell.point *= pieces);
        let part = |s: &f64| std::iter::repeat_n(s / pieces as f64, pieces);
        let interval_s: Vec<f64> = curve.interval_s.iter().flat_map(part).collect();
        let mut point_rad = Vec::new();
        for (i, t_s) in frame.times_s(&interval_s).into_iter().enumerate() {
            let sample = motion.at(t_s);
            for joint in 0..self.joints() {
                // Key points are taken as they are, without rounding.
                let given = (i % pieces == 0).then(|| curve.point_rad[i / pieces * self.joints() + joint]);
                point_rad.push(given.unwrap_or_else(|| sample.of(Quantity::Position, joint)[0]));
            }
        }
        Ok((frame, Curve { interval_s, point_rad }))
    }
}
