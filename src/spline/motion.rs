//! A plan as the arm runs it: splines, and rests at key points between them.
//!
//! A spline through two equal key points drifts between them; so a motion is split at every
//! dwell into splines that come to rest, and is exactly constant while it dwells.

use std::ops::Range;

use super::{Degree, Ends, Extrema, KeyPoints, Quantity, Samples, Spline, SplineError, error::check};

/// A rest at a key point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dwell {
    /// Index of the key point.
    pub point: usize,
    /// How long, s; 0 only stops there.
    pub length_s: f64,
}

/// A stretch without rests.
#[derive(Debug, Clone, PartialEq)]
pub struct Segment {
    /// When it starts, s since the start of the motion's times.
    pub start_s: f64,
    /// Index of its first key point.
    pub first_point: usize,
    /// The spline, in time since `start_s`.
    pub spline: Spline,
}

impl Segment {
    /// Indices of its first and last key point.
    pub fn ends(&self) -> (usize, usize) {
        (self.first_point, self.first_point + self.spline.points().len() - 1)
    }
}

/// Splines with exactly constant dwells between them.
///
/// The time of a key point is the arrival there; a dwell follows the arrival and takes its
/// length from the interval to the next key point. A dwell at the last key point comes on top.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    points: KeyPoints,
    /// By key point, s; NaN where the motion passes through.
    dwell_s: Vec<f64>,
    segments: Vec<Segment>,
    t_s: Vec<f64>,
    // Workspace: times of one segment.
    local_s: Vec<f64>,
}

impl Motion {
    /// Plans a motion: `t_s[i]` is when the arm arrives at key point i, s.
    ///
    /// `ends` hold at the start and the end of the whole motion; next to a dwell all derivatives are zero.
    ///
    /// # Errors
    ///
    /// [`SplineError`]: as [`Spline::new`], dwells out of order or longer than their interval,
    /// or a first or last key point with a dwell where `ends` ask for motion.
    pub fn new(
        degree: Degree,
        points: KeyPoints,
        ends: &Ends,
        dwells: &[Dwell],
        t_s: &[f64],
    ) -> Result<Self, SplineError> {
        ends.check(points.joints())?;
        check("time", t_s, points.len())?;
        let last = points.len() - 1;
        let mut dwell_s = vec![f64::NAN; points.len()];
        for (index, dwell) in dwells.iter().enumerate() {
            let point = dwell.point;
            if point > last || index > 0 && dwells[index - 1].point >= point {
                return Err(SplineError::BadDwell { index, point, points: points.len() });
            }
            check("dwell", &[dwell.length_s], 1)?;
            if dwell.length_s < 0.0 {
                return Err(SplineError::NegativeDwell { point, length_s: dwell.length_s });
            }
            let moving = |derivatives: [f64; 3]| derivatives.iter().any(|value| value.abs() > 0.0);
            let moves = |joint: &usize| {
                point == 0 && moving(ends.start(*joint)) || point == last && moving(ends.end(*joint))
            };
            if let Some(joint) = (0..points.joints()).find(moves) {
                return Err(SplineError::MovingDwell { point, joint });
            }
            dwell_s[point] = dwell.length_s;
        }
        let rest = Ends::at_rest(points.joints());
        let mut motion =
            Self { dwell_s, segments: Vec::new(), t_s: t_s.to_vec(), local_s: Vec::new(), points };
        let mut first = 0;
        for point in 1..=last {
            if point < last && motion.dwell_s[point].is_nan() {
                continue;
            }
            let mut own = rest.clone();
            if first == 0 {
                own.start_velocity_rad_s.clone_from(&ends.start_velocity_rad_s);
                own.start_acceleration_rad_s2.clone_from(&ends.start_acceleration_rad_s2);
                own.start_jerk_rad_s3.clone_from(&ends.start_jerk_rad_s3);
            }
            if point == last {
                own.end_velocity_rad_s.clone_from(&ends.end_velocity_rad_s);
                own.end_acceleration_rad_s2.clone_from(&ends.end_acceleration_rad_s2);
                own.end_jerk_rad_s3.clone_from(&ends.end_jerk_rad_s3);
            }
            let start_s = localise(t_s, &motion.dwell_s, first, point, &mut motion.local_s);
            let spline = Spline::new(degree, motion.points.stretch(first, point), &own, &motion.local_s)
                .map_err(|error| elsewhere(error, first, start_s))?;
            motion.segments.push(Segment { start_s, first_point: first, spline });
            first = point;
        }
        Ok(motion)
    }

    /// Runs the same key points and dwells at other times. Allocates nothing.
    ///
    /// # Errors
    ///
    /// As [`Motion::new`]; the motion is then as it was.
    pub fn retime(&mut self, t_s: &[f64]) -> Result<(), SplineError> {
        check("time", t_s, self.points.len())?;
        for segment in &mut self.segments {
            let (first, last) = segment.ends();
            let start_s = localise(t_s, &self.dwell_s, first, last, &mut self.local_s);
            segment.spline.try_times(&self.local_s).map_err(|error| elsewhere(error, first, start_s))?;
        }
        for segment in &mut self.segments {
            segment.start_s = start(t_s, &self.dwell_s, segment.first_point);
            segment.spline.take_times();
        }
        self.t_s.copy_from_slice(t_s);
        Ok(())
    }

    /// The degree.
    pub fn degree(&self) -> Degree {
        self.segments.first().map_or_else(Degree::default, |segment| segment.spline.degree())
    }

    /// Number of joints.
    pub fn joints(&self) -> usize {
        self.points.joints()
    }

    /// The key points.
    pub fn points(&self) -> &KeyPoints {
        &self.points
    }

    /// Arrivals at the key points, s.
    pub fn t_s(&self) -> &[f64] {
        &self.t_s
    }

    /// The stretches between rests, at least one, in order.
    pub fn segments(&self) -> &[Segment] {
        &self.segments
    }

    /// Length of the rest at a key point, s; `None` where the motion passes through.
    pub fn dwell_s(&self, point: usize) -> Option<f64> {
        self.dwell_s.get(point).copied().filter(|length_s| !length_s.is_nan())
    }

    /// From the first arrival to the end of the last movement or rest, s.
    pub fn duration_s(&self) -> f64 {
        let last = self.t_s.len() - 1;
        self.t_s[last] - self.t_s[0] + self.dwell_s(last).unwrap_or(0.0)
    }

    /// The segment that moves at an instant or rests before the next one starts, and the key
    /// point at which it then rests.
    fn place(&self, t_s: f64) -> (usize, Option<usize>) {
        let index = self.segments[1..].partition_point(|segment| segment.start_s <= t_s);
        let segment = &self.segments[index];
        let (first, last) = segment.ends();
        let local_s = t_s - segment.start_s;
        let end = if local_s >= segment.spline.duration_s() {
            Some(last)
        } else {
            (local_s <= 0.0).then_some(first)
        };
        (index, end.filter(|point| !self.dwell_s[*point].is_nan()))
    }

    /// Position, velocity, acceleration and jerk of all joints at one instant. Before the start
    /// and after the end it is the state there.
    pub fn at(&self, t_s: f64) -> Samples {
        let mut samples = Samples::default();
        self.sample(&[t_s], Quantity::Jerk, &mut samples);
        samples
    }

    /// Quantities up to `through` of all joints at many instants, cheapest when ascending.
    pub fn sample(&self, t_s: &[f64], through: Quantity, samples: &mut Samples) {
        samples.shape(self.joints(), t_s.len(), through);
        let mut column = 0;
        while column < t_s.len() {
            let place = self.place(t_s[column]);
            let run = 1 + t_s[column + 1..].iter().take_while(|t| self.place(**t) == place).count();
            match place {
                (_, Some(point)) => samples.hold(self.points.of(point), column..column + run),
                (index, None) => {
                    let Segment { start_s, spline, .. } = &self.segments[index];
                    spline.sample_into(&t_s[column..column + run], *start_s, through, samples, column);
                }
            }
            column += run;
        }
    }

    /// All quantities at instants whose segments are known, `[segment]`; at a rest the ends of the curves.
    pub(crate) fn sample_segments(&self, t_s: &[f64], ranges: &[Range<usize>], samples: &mut Samples) {
        samples.shape(self.joints(), t_s.len(), Quantity::Jerk);
        for (range, segment) in ranges.iter().zip(&self.segments) {
            let instants = &t_s[range.clone()];
            segment.spline.sample_into(instants, segment.start_s, Quantity::Jerk, samples, range.start);
        }
    }

    /// Root mean square of each joint's jerk over the whole motion, dwells included, rad/s³, into `rms`, `[joint]`.
    pub fn rms_jerk(&self, rms_rad_s3: &mut [f64]) {
        rms_rad_s3.fill(0.0);
        for segment in &self.segments {
            segment.spline.add_squared_jerk(rms_rad_s3);
        }
        let duration_s = self.duration_s();
        for value in rms_rad_s3 {
            *value = (*value / duration_s).sqrt();
        }
    }

    /// Exact least and greatest value over the whole motion; panics if there is no such joint.
    pub fn extrema(&self, joint: usize, quantity: Quantity) -> Extrema {
        let shifted = |segment: &Segment| {
            let mut extrema = segment.spline.extrema(joint, quantity);
            extrema.least.t_s += segment.start_s;
            extrema.greatest.t_s += segment.start_s;
            extrema
        };
        let mut all = shifted(&self.segments[0]);
        for extrema in self.segments[1..].iter().map(shifted) {
            all.widen(extrema.least.value, extrema.least.t_s);
            all.widen(extrema.greatest.value, extrema.greatest.t_s);
        }
        all
    }
}

/// Departure from a key point, s.
fn start(t_s: &[f64], dwell_s: &[f64], point: usize) -> f64 {
    t_s[point] + dwell_s[point].max(0.0)
}

/// Times of the key points `first..=last` since the departure from the first, which is returned.
fn localise(t_s: &[f64], dwell_s: &[f64], first: usize, last: usize, local_s: &mut Vec<f64>) -> f64 {
    let start_s = start(t_s, dwell_s, first);
    local_s.clear();
    local_s.extend(t_s[first..=last].iter().map(|t| t - start_s));
    local_s[0] = 0.0;
    start_s
}

/// The error as the whole motion counts points and time.
fn elsewhere(error: SplineError, first: usize, start_s: f64) -> SplineError {
    match error {
        SplineError::NotIncreasing { index, leave_s, arrive_s } => SplineError::NotIncreasing {
            index: index + first,
            leave_s: leave_s + start_s,
            arrive_s: arrive_s + start_s,
        },
        other => other,
    }
}
