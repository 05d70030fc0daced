//! The spline: key points and times in, control points of position and derivatives out.

use super::{Degree, Ends, KeyPoints, Quantity, SplineError, error::check, knots::Knots, solve, solve::Band};

/// Shortest interval relative to the largest stamp, far above the rounding of mid-points.
const LEAST_INTERVAL: f64 = 1e-12;

const LEAST_INTERVAL_S: f64 = 1e-6;

/// A B-spline of all joints through key points at strictly increasing times.
///
/// Outside its time span it holds the state of the nearer end. A joint, piece or interval that there is not panics.
#[derive(Debug, Clone, PartialEq)]
pub struct Spline {
    degree: Degree,
    points: KeyPoints,
    ends: Ends,
    t_s: Vec<f64>,
    pub(super) knots: Knots,
    /// Control points of position, velocity, acceleration, jerk, each `[joint][control]`.
    pub(super) controls: [Vec<f64>; 4],
    // Workspace: the times being tried, their knots, the factored system.
    tried_s: Vec<f64>,
    tried: Knots,
    band: Band,
}

impl Spline {
    /// Fits a spline: `t_s[i]` is when the joints are at key point i, s.
    ///
    /// # Errors
    ///
    /// [`SplineError`]: lengths that do not match, values that are not finite, times that do
    /// not increase by more than 1 µs (and 1e-12 of the largest) or intervals too unequal.
    pub fn new(degree: Degree, points: KeyPoints, ends: &Ends, t_s: &[f64]) -> Result<Self, SplineError> {
        ends.check(points.joints())?;
        let knots = Knots::of(degree, points.len());
        let stretch = |order: usize| vec![0.0; (knots.controls() - order) * points.joints()];
        let mut spline = Self {
            degree,
            ends: ends.clone(),
            t_s: vec![0.0; points.len()],
            controls: [stretch(0), stretch(1), stretch(2), stretch(3)],
            tried_s: vec![0.0; points.len()],
            tried: knots.clone(),
            band: Band::of(degree, points.len()),
            knots,
            points,
        };
        spline.retime(t_s)?;
        Ok(spline)
    }

    /// Fits the same key points at other times. Allocates nothing; O(points × joints).
    ///
    /// # Errors
    ///
    /// As [`Spline::new`]; the spline is then as it was.
    pub fn retime(&mut self, t_s: &[f64]) -> Result<(), SplineError> {
        self.try_times(t_s)?;
        self.take_times();
        Ok(())
    }

    /// Checks times and factors their system, but leaves the spline as it is.
    pub(super) fn try_times(&mut self, t_s: &[f64]) -> Result<(), SplineError> {
        check("time", t_s, self.points.len())?;
        let largest = t_s.iter().fold(0.0, |most: f64, t| most.max(t.abs()));
        let least = LEAST_INTERVAL_S.max(LEAST_INTERVAL * largest);
        for (i, pair) in t_s.windows(2).enumerate() {
            if pair[1] - pair[0] < least {
                return Err(SplineError::NotIncreasing { index: i + 1, leave_s: pair[0], arrive_s: pair[1] });
            }
        }
        self.tried_s.copy_from_slice(t_s);
        self.tried.place(t_s);
        self.band.factor(&self.tried, t_s)
    }

    /// Moves to the times last tried with success: control points of position from the
    /// factored system, then of its derivatives.
    pub(super) fn take_times(&mut self) {
        std::mem::swap(&mut self.knots, &mut self.tried);
        std::mem::swap(&mut self.t_s, &mut self.tried_s);
        let (knots, fixed) = (&self.knots, self.degree.fixed());
        let (controls, last) = (knots.controls(), self.points.len() - 1);
        let (from_start, from_end) = (solve::reach_from_start(knots), solve::reach_from_end(knots));
        for (joint, control) in self.controls[0].chunks_exact_mut(controls).enumerate() {
            let [v, a, j] = self.ends.end(joint);
            let (head, tail) = (self.ends.start(joint), [-v, a, -j]);
            solve::fix(&from_start, self.points.of(0)[joint], head, control[..fixed].iter_mut());
            let end = control[controls - fixed..].iter_mut().rev();
            solve::fix(&from_end, self.points.of(last)[joint], tail, end);
            for (i, interior) in control[fixed..controls - fixed].iter_mut().enumerate() {
                *interior = self.points.of(i + 1)[joint];
            }
            self.band.solve(control);
        }
        for order in 1..4 {
            let (below, above) = self.controls.split_at_mut(order);
            let count = controls - order;
            let (width, factor) = (knots.degree + 1 - order, (knots.degree + 1 - order) as f64);
            for (from, to) in below[order - 1].chunks_exact(count + 1).zip(above[0].chunks_exact_mut(count)) {
                let reciprocals = knots.reciprocals(order, width);
                for (((to, low), high), reciprocal) in
                    to.iter_mut().zip(from).zip(&from[1..]).zip(reciprocals)
                {
                    *to = factor * (high - low) * reciprocal;
                }
            }
        }
    }

    /// The degree.
    pub fn degree(&self) -> Degree {
        self.degree
    }

    /// Number of joints.
    pub fn joints(&self) -> usize {
        self.points.joints()
    }

    /// The key points.
    pub fn points(&self) -> &KeyPoints {
        &self.points
    }

    /// Times of the key points, s.
    pub fn t_s(&self) -> &[f64] {
        &self.t_s
    }

    /// First and last instant, s.
    pub fn span_s(&self) -> (f64, f64) {
        let breaks = self.knots.breaks();
        (breaks[0], breaks[breaks.len() - 1])
    }

    /// Time from the first key point to the last, s.
    pub fn duration_s(&self) -> f64 {
        let (start, end) = self.span_s();
        end - start
    }

    /// The knots, s, ends repeated.
    pub fn knots_s(&self) -> &[f64] {
        &self.knots.u
    }

    /// Control points of one joint's position or derivative. The curve lies between the least and the greatest of them.
    #[inline]
    pub fn control(&self, joint: usize, quantity: Quantity) -> &[f64] {
        let order = quantity.order();
        let count = self.knots.controls() - order;
        &self.controls[order][joint * count..][..count]
    }
}
