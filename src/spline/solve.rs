//! The interior control points: a banded system, factored once for all joints.
//!
//! Row i asks the curve to pass key point i. The matrix is totally positive, so elimination
//! without pivoting is stable (de Boor and Pinkus 1977, doi:10.1007/BF01389315).

use super::{Degree, SplineError, basis, knots::Knots};

/// Largest norm of the inverse accepted: about the factor by which rounding grows. It is 7 to
/// 23 for equal intervals and below 1e6 for seven key points with intervals from 0.3 to 20 s.
const LARGEST_INVERSE: f64 = 1e8;

/// The factored matrix: for every interior key point a row of `2 half + 1` entries.
///
/// Control points at the ends are known; they stand in the system as rows of the identity,
/// so their columns need no special treatment in the substitutions.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Band {
    half: usize,
    rows: Vec<f64>,
    reciprocal_pivots: Vec<f64>,
    /// Workspace of one joint's control points.
    probe: Vec<f64>,
}

impl Band {
    /// Room for the system of `points` key points.
    pub(super) fn of(degree: Degree, points: usize) -> Self {
        let half = degree.fixed() - 1;
        let unknowns = points - 2;
        Self {
            half,
            rows: vec![0.0; unknowns * (2 * half + 1)],
            reciprocal_pivots: vec![0.0; unknowns],
            probe: vec![0.0; unknowns + 2 * degree.fixed()],
        }
    }

    /// Fills and factors the matrix.
    ///
    /// # Errors
    ///
    /// [`SplineError::IllConditioned`].
    pub(super) fn factor(&mut self, knots: &Knots, t_s: &[f64]) -> Result<(), SplineError> {
        match knots.degree {
            5 => self.factor_of::<5>(knots, t_s),
            6 => self.factor_of::<6>(knots, t_s),
            _ => self.factor_of::<7>(knots, t_s),
        }
        let inverse = self.inverse_norm();
        if inverse <= LARGEST_INVERSE { Ok(()) } else { Err(SplineError::IllConditioned { inverse }) }
    }

    /// Maximum norm of the inverse; infinite if a pivot vanished. The inverse of a totally positive matrix has the
    /// signs of a chessboard, so the key points 1, -1, 1, ... attain it.
    fn inverse_norm(&mut self) -> f64 {
        let mut probe = std::mem::take(&mut self.probe);
        probe.fill(0.0);
        let unknowns = &mut probe[self.half + 1..];
        for (r, value) in unknowns.iter_mut().enumerate().take(self.reciprocal_pivots.len()) {
            *value = if r % 2 == 0 { 1.0 } else { -1.0 };
        }
        self.solve(&mut probe);
        let finite = probe.iter().all(|x| x.is_finite());
        let largest = probe.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        self.probe = probe;
        if finite { largest } else { f64::INFINITY }
    }

    fn factor_of<const DEGREE: usize>(&mut self, knots: &Knots, t_s: &[f64]) {
        let (half, width) = (self.half, 2 * self.half + 1);
        for r in 0..self.reciprocal_pivots.len() {
            let row = basis::row::<DEGREE, 1>(knots, r + 1, &[t_s[r + 1]]);
            let (above, rest) = self.rows.split_at_mut(r * width);
            let entries = &mut rest[..width];
            for (entry, [value]) in entries.iter_mut().zip(row) {
                *entry = value;
            }
            // Columns left of the first unknown belong to known control points.
            for j in half.saturating_sub(r)..half {
                let pivot_row = r + j - half;
                let factor = entries[j] * self.reciprocal_pivots[pivot_row];
                entries[j] = factor;
                let source = &above[pivot_row * width + half + 1..(pivot_row + 1) * width];
                for (entry, value) in entries[j + 1..].iter_mut().zip(source) {
                    *entry -= factor * value;
                }
            }
            self.reciprocal_pivots[r] = 1.0 / entries[half];
        }
    }

    /// Solves for one joint: `control` holds the known control points at both ends and the
    /// key points between them, and the control points afterwards.
    pub(super) fn solve(&self, control: &mut [f64]) {
        // The width as a constant lets the compiler unroll.
        match self.half {
            2 => self.solve_of::<2>(control),
            _ => self.solve_of::<3>(control),
        }
    }

    fn solve_of<const HALF: usize>(&self, control: &mut [f64]) {
        let rows = || self.rows.chunks_exact(2 * HALF + 1).zip(&self.reciprocal_pivots).enumerate();
        for (r, (row, _)) in rows() {
            let known: f64 = row[..HALF].iter().zip(&control[r + 1..][..HALF]).map(|(a, x)| a * x).sum();
            control[r + 1 + HALF] -= known;
        }
        for (r, (row, reciprocal)) in rows().rev() {
            let known: f64 =
                row[HALF + 1..].iter().zip(&control[r + 2 + HALF..][..HALF]).map(|(a, x)| a * x).sum();
            control[r + 1 + HALF] = (control[r + 1 + HALF] - known) * reciprocal;
        }
    }
}

/// How far each derivative reaches on the way from one control point to the next, by control
/// point and order, s; equal for all joints.
pub(super) type Reach = [[f64; 3]; 4];

/// Reaches from the start inwards.
pub(super) fn reach_from_start(knots: &Knots) -> Reach {
    reach(knots.degree, |k, r| knots.u[k + knots.degree + 1] - knots.u[k + r])
}

/// Reaches from the end inwards: those of the time-reversed knots.
pub(super) fn reach_from_end(knots: &Knots) -> Reach {
    let last = knots.u.len() - 1;
    reach(knots.degree, |k, r| knots.u[last - k - r] - knots.u[last - k - knots.degree - 1])
}

fn reach(degree: usize, width: impl Fn(usize, usize) -> f64) -> Reach {
    let mut reach = [[0.0; 3]; 4];
    for (k, row) in reach.iter_mut().enumerate() {
        for (r, reach) in row.iter_mut().enumerate() {
            *reach = width(k, r + 1) / (degree - r) as f64;
        }
    }
    reach
}

/// Control points from an end inwards, in closed form, from position and derivatives there;
/// odd derivatives change sign at the end.
pub(super) fn fix<'a>(
    reach: &Reach,
    position: f64,
    [v, a, j]: [f64; 3],
    control: impl Iterator<Item = &'a mut f64>,
) {
    // Control points of derivative 0, 1, 2, 3 at the current place.
    let mut tower = [position, v, a, j];
    for (control, reach) in control.zip(reach) {
        *control = tower[0];
        for r in 0..3 {
            // Entries too high up are never used: there are at most four control points.
            tower[r] += tower[r + 1] * reach[r];
        }
    }
}
