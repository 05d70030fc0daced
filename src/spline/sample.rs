//! States at given instants.

use std::ops::Range;

use multiversion::multiversion;

use super::{
    Quantity, Spline,
    basis::{self, Row},
};

/// Instants evaluated together; they share one piece.
const LANES: usize = 8;

/// States of all joints at some instants; reused, it allocates only to grow.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Samples {
    pub(super) instants: usize,
    /// By order of derivative, each `[joint][instant]`; those not asked for are empty.
    pub(super) values: [Vec<f64>; 4],
}

impl Samples {
    /// Number of instants.
    pub fn instants(&self) -> usize {
        self.instants
    }

    /// One quantity, `[joint][instant]`; empty if it was not asked for.
    pub fn all(&self, quantity: Quantity) -> &[f64] {
        &self.values[quantity.order()]
    }

    /// One quantity of one joint, `[instant]`; panics if there is no such joint or the quantity was not asked for.
    pub fn of(&self, quantity: Quantity, joint: usize) -> &[f64] {
        &self.all(quantity)[joint * self.instants..][..self.instants]
    }

    /// One quantity of one joint to be changed, `[instant]`; as [`Samples::of`].
    pub(crate) fn of_mut(&mut self, quantity: Quantity, joint: usize) -> &mut [f64] {
        &mut self.values[quantity.order()][joint * self.instants..][..self.instants]
    }

    /// Makes room for quantities up to `through`.
    pub(super) fn shape(&mut self, joints: usize, instants: usize, through: Quantity) {
        self.instants = instants;
        for (order, values) in self.values.iter_mut().enumerate() {
            let length = if order <= through.order() { joints * instants } else { 0 };
            values.resize(length, 0.0);
        }
    }

    pub(super) fn hold(&mut self, position_rad: &[f64], columns: Range<usize>) {
        let stride = self.instants;
        for (order, values) in self.values.iter_mut().enumerate() {
            for (row, position) in values.chunks_exact_mut(stride).zip(position_rad) {
                row[columns.clone()].fill(if order == 0 { *position } else { 0.0 });
            }
        }
    }
}

impl Spline {
    /// Position, velocity, acceleration and jerk of all joints at one instant; at the nearer end if it lies outside.
    pub fn at(&self, t_s: f64) -> Samples {
        let mut samples = Samples::default();
        self.sample(&[t_s], Quantity::Jerk, &mut samples);
        samples
    }

    /// Quantities up to `through` of all joints at many instants, cheapest when ascending.
    #[inline]
    pub fn sample(&self, t_s: &[f64], through: Quantity, samples: &mut Samples) {
        samples.shape(self.joints(), t_s.len(), through);
        self.sample_into(t_s, 0.0, through, samples, 0);
    }

    /// As [`Spline::sample`], at instants since `origin_s`, into the columns from `first` on of samples that have room.
    #[inline]
    pub(super) fn sample_into(
        &self,
        t_s: &[f64],
        origin_s: f64,
        through: Quantity,
        samples: &mut Samples,
        first: usize,
    ) {
        let (start, end) = self.span_s();
        let breaks = self.knots.breaks();
        let (mut done, mut piece) = (0, 0);
        while done < t_s.len() {
            let mut instants = [(t_s[done] - origin_s).clamp(start, end); LANES];
            if instants[0] < breaks[piece] || instants[0] >= breaks[piece + 1] {
                piece = self.knots.piece(instants[0]);
            }
            let upper = if piece + 2 == breaks.len() { f64::INFINITY } else { breaks[piece + 1] };
            let mut count = 1;
            for t in t_s[done + 1..].iter().take(LANES - 1) {
                let t = (t - origin_s).clamp(start, end);
                if !(t >= breaks[piece] && t < upper) {
                    break;
                }
                instants[count] = t;
                count += 1;
            }
            let column = first + done..first + done + count;
            dispatched(self, piece, &instants, through.order(), samples, column);
            done += count;
        }
    }

    /// Fills columns from instants of one piece.
    #[inline(always)]
    fn lanes<const DEGREE: usize, const WHOLE: bool>(
        &self,
        piece: usize,
        t_s: &[f64; LANES],
        through: usize,
        samples: &mut Samples,
        columns: Range<usize>,
    ) {
        let mut row: Row<LANES> = basis::constant();
        for degree in 0..=DEGREE {
            if degree > 0 {
                basis::raise(&mut row, degree, &self.knots, piece, t_s);
            }
            let order = DEGREE - degree;
            if order > through || order > 3 {
                continue;
            }
            let stride = self.knots.controls() - order;
            let controls = self.controls[order].chunks_exact(stride);
            let lines = samples.values[order].chunks_exact_mut(samples.instants);
            for (control, line) in controls.zip(lines) {
                let sum = basis::weigh(&control[piece..=piece + degree], &row);
                let line = &mut line[columns.clone()];
                if !WHOLE {
                    line.copy_from_slice(&sum[..line.len()]);
                } else if let Some(line) = line.first_chunk_mut() {
                    *line = sum;
                }
            }
        }
    }
}

/// Instants of one piece, by the widest vector unit of the processor; the result does not depend on which.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl", "x86_64+avx2", "x86_64+sse4.1"))]
fn dispatched(
    spline: &Spline,
    piece: usize,
    t_s: &[f64; LANES],
    through: usize,
    samples: &mut Samples,
    columns: Range<usize>,
) {
    // The degree as a constant lets the compiler unroll, a whole group copy without a call.
    match (spline.knots.degree, columns.len() == LANES) {
        (5, true) => spline.lanes::<5, true>(piece, t_s, through, samples, columns),
        (5, false) => spline.lanes::<5, false>(piece, t_s, through, samples, columns),
        (6, true) => spline.lanes::<6, true>(piece, t_s, through, samples, columns),
        (6, false) => spline.lanes::<6, false>(piece, t_s, through, samples, columns),
        (_, true) => spline.lanes::<7, true>(piece, t_s, through, samples, columns),
        (_, false) => spline.lanes::<7, false>(piece, t_s, through, samples, columns),
    }
}
