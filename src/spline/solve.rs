//! The interior control points: a banded system, factored once for all joints.
//!
//! Row i asks the curve to pass key point i. The matrix is totally positive, so elimination
//! without pivoting is stable (de Boor and Pinkus 1977, doi:10.1007/BF01389315).

use super::{Degree, SplineError, basis, knots::Knots};

/// Smallest pivot accepted. Rows sum to 1; pivots of equal intervals are near 0.5.
const LEAST_PIVOT: f64 = 1e-9;

/// The factored matrix: for every interior key point a row of `2 half + 1` entries.
///
/// Control points at the ends are known; they stand in the system as rows of the identity,
/// so their columns need no special treatment in the substitutions.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Band {
    half: usize,
    rows: Vec<f64>,
    reciprocal_pivots: Vec<f64>,
}

impl Band {
    /// Room for the system of `points` key points.
    pub(super) fn of(degree: Degree, points: usize) -> Self {
        let half = degree.fixed() - 1;
        let unknowns = points - 2;
        Self { half, rows: vec![0.0; unknowns * (2 * half + 1)], reciprocal_pivots: vec![0.0; unknowns] }
    }

    /// Fills and factors the matrix.
    ///
    /// # Errors
    ///
    /// [`SplineError::IllConditioned`].
    pub(super) fn factor(&mut self, knots: &Knots, t_s: &[f64]) -> Result<(), SplineError> {
        let (half, width) = (self.half, 2 * self.half + 1);
        for r in 0..self.reciprocal_pivots.len() {
            let row = basis::row(knots.degree, knots, r + 1, &[t_s[r + 1]]);
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
            let pivot = entries[half];
            if pivot.is_nan() || pivot < LEAST_PIVOT {
                return Err(SplineError::IllConditioned { index: r + 1, pivot });
            }
            self.reciprocal_pivots[r] = 1.0 / pivot;
        }
        Ok(())
    }

    /// Solves for one joint: `control` holds the known control points at both ends and the
    /// key points between them, and the control points afterwards.
    pub(super) fn solve(&self, control: &mut [f64]) {
        let (half, width) = (self.half, 2 * self.half + 1);
        let rows = || self.rows.chunks_exact(width).zip(&self.reciprocal_pivots).enumerate();
        for (r, (row, _)) in rows() {
            let known: f64 = row[..half].iter().zip(&control[r + 1..]).map(|(a, x)| a * x).sum();
            control[r + 1 + half] -= known;
        }
        for (r, (row, reciprocal)) in rows().rev() {
            let known: f64 = row[half + 1..].iter().zip(&control[r + 2 + half..]).map(|(a, x)| a * x).sum();
            control[r + 1 + half] = (control[r + 1 + half] - known) * reciprocal;
        }
    }
}

/// Control points at the start from position and `derivatives` there, in closed form.
pub(super) fn start(knots: &Knots, position: f64, derivatives: [f64; 3], control: &mut [f64]) {
    fix(knots.degree, position, derivatives, control.iter_mut(), |k, r| {
        knots.u[k + knots.degree + 1] - knots.u[k + r]
    });
}

/// Control points at the end, likewise: the start of the time-reversed curve.
pub(super) fn end(knots: &Knots, position: f64, [v, a, j]: [f64; 3], control: &mut [f64]) {
    let last = knots.u.len() - 1;
    fix(knots.degree, position, [-v, a, -j], control.iter_mut().rev(), |k, r| {
        knots.u[last - k - r] - knots.u[last - k - knots.degree - 1]
    });
}

/// Walks from the end inwards. `tower` holds the control points of derivative 0, 1, 2, 3 at
/// the current place; `width(k, r)` is the knot difference below control point k of
/// derivative r.
fn fix<'a>(
    degree: usize,
    position: f64,
    [v, a, j]: [f64; 3],
    control: impl Iterator<Item = &'a mut f64>,
    width: impl Fn(usize, usize) -> f64,
) {
    let mut tower = [position, v, a, j];
    for (k, control) in control.enumerate() {
        *control = tower[0];
        for r in 0..3 {
            // Entries too high up are never used: there are at most four control points.
            tower[r] += tower[r + 1] * width(k, r + 1) / (degree - r) as f64;
        }
    }
}
