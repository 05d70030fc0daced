//! One polynomial piece in Bernstein form, and its stationary points.

use multiversion::multiversion;

use super::{Quantity, Spline, basis::WIDTH, knots::Knots};

/// A polynomial over [0, 1] by its Bernstein coefficients; it lies between the least and the
/// greatest of them and meets the first and the last.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bernstein {
    degree: usize,
    coefficients: [f64; WIDTH],
}

/// Width at which several stationary points count as one: values there differ by the square.
const TOGETHER: f64 = 1e-9;

impl Spline {
    /// A quantity of one joint on `from_s..to_s` within one piece, by blossoming: all steps
    /// are convex combinations of control points.
    pub(super) fn bernstein(
        &self,
        joint: usize,
        quantity: Quantity,
        piece: usize,
        (from_s, to_s): (f64, f64),
    ) -> Bernstein {
        let control = &self.control(joint, quantity)[piece..];
        let (knots, first) = (&self.knots, piece + quantity.order());
        let degree = knots.degree - quantity.order();
        Bernstein { degree, coefficients: dispatched(knots, degree, first, control, [from_s, to_s]) }
    }
}

/// Coefficients on `[from_s, to_s]` of the piece whose knots and control points start here, by the widest vector unit
/// of the processor; the result does not depend on which.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl", "x86_64+avx2", "x86_64+sse4.1"))]
fn dispatched(knots: &Knots, degree: usize, first: usize, control: &[f64], ends_s: [f64; 2]) -> [f64; WIDTH] {
    // The degree as a constant lets the compiler unroll.
    match degree {
        2 => blossoms::<2>(knots, first, control, ends_s),
        3 => blossoms::<3>(knots, first, control, ends_s),
        4 => blossoms::<4>(knots, first, control, ends_s),
        5 => blossoms::<5>(knots, first, control, ends_s),
        6 => blossoms::<6>(knots, first, control, ends_s),
        _ => blossoms::<7>(knots, first, control, ends_s),
    }
}

/// All coefficients at once: the one of lane `i` takes in the start `DEGREE - i` times and then the end.
#[inline(always)]
fn blossoms<const DEGREE: usize>(
    knots: &Knots,
    first: usize,
    control: &[f64],
    [from_s, to_s]: [f64; 2],
) -> [f64; WIDTH] {
    let mut values = [[0.0; WIDTH]; WIDTH];
    for (value, control) in values[..=DEGREE].iter_mut().zip(control) {
        *value = [*control; WIDTH];
    }
    // De Boor's algorithm, a level for each argument of the blossom.
    for level in 1..=DEGREE {
        let reciprocals = &knots.reciprocals(first + level, DEGREE + 1 - level)[..=DEGREE - level];
        let left_s = &knots.u[first + level..][..=DEGREE - level];
        let mut t_s = [to_s; WIDTH];
        t_s[..=DEGREE - level].fill(from_s);
        for k in (level..=DEGREE).rev() {
            let (reciprocal, left_s) = (reciprocals[k - level], left_s[k - level]);
            for l in 0..WIDTH {
                let share = (t_s[l] - left_s) * reciprocal;
                values[k][l] = (1.0 - share) * values[k - 1][l] + share * values[k][l];
            }
        }
    }
    values[DEGREE]
}

impl Bernstein {
    pub(super) fn coefficients(&self) -> &[f64] {
        &self.coefficients[..=self.degree]
    }

    /// Value at `x` and slope with respect to it, by de Casteljau.
    pub(super) fn at(&self, x: f64) -> (f64, f64) {
        let mut c = self.coefficients;
        for level in (1..self.degree).rev() {
            for k in 0..=level {
                c[k] += x * (c[k + 1] - c[k]);
            }
        }
        if self.degree == 0 {
            (c[0], 0.0)
        } else {
            (c[0] + x * (c[1] - c[0]), self.degree as f64 * (c[1] - c[0]))
        }
    }

    /// Calls `found` with every point inside (0, 1) where the slope changes sign; extra points may be among them.
    pub(super) fn stationary(&self, mut found: impl FnMut(f64)) {
        let c = self.coefficients();
        let largest = c.iter().fold(0.0, |most: f64, c| most.max(c.abs()));
        let mut slope = Self { degree: self.degree.saturating_sub(1), coefficients: [0.0; WIDTH] };
        for (slope, pair) in slope.coefficients.iter_mut().zip(c.windows(2)) {
            let rise = pair[1] - pair[0];
            // Differences within rounding would only invent roots of no consequence.
            *slope = if rise.abs() > 4.0 * f64::EPSILON * largest { rise } else { 0.0 };
        }
        slope.roots(0.0, 1.0, &mut found);
    }

    /// Sign changes between coefficients, zeros left out: at least the number of roots inside,
    /// and equal to it if 0 or 1 (Descartes).
    fn variations(&self) -> usize {
        let mut signs = self.coefficients().iter().filter(|c| **c != 0.0).map(|c| *c > 0.0);
        let Some(mut last) = signs.next() else { return 0 };
        signs.filter(|sign| std::mem::replace(&mut last, *sign) != *sign).count()
    }

    /// Roots inside (0, 1), placed on `from..to`.
    fn roots(&self, from: f64, to: f64, found: &mut impl FnMut(f64)) {
        let place = |x: f64| from + x * (to - from);
        match self.variations() {
            0 => {}
            1 => found(place(self.only_root())),
            _ if to - from < TOGETHER => found(place(0.5)),
            _ => {
                let (left, right) = self.halves();
                if right.coefficients[0] == 0.0 {
                    found(place(0.5));
                }
                left.roots(from, place(0.5), found);
                right.roots(place(0.5), to, found);
            }
        }
    }

    /// The root where coefficients change sign once: Newton's steps, kept inside a bracket.
    fn only_root(&self) -> f64 {
        let starts_below = self.coefficients().iter().find(|c| **c != 0.0).is_some_and(|c| *c < 0.0);
        let (mut low, mut high, mut x) = (0.0, 1.0, 0.5);
        for _ in 0..64 {
            let (value, slope) = self.at(x);
            if value == 0.0 {
                break;
            }
            if (value < 0.0) == starts_below {
                low = x;
            } else {
                high = x;
            }
            let step = value / slope;
            // Such a step squares what is left; testing it against the bracket would fail by
            // rounding and send the search away.
            if step.abs() < 1e-9 {
                return (x - step).clamp(low, high);
            }
            let newton = x - step;
            x = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
        }
        x
    }

    /// The parts on [0, 1/2] and [1/2, 1], each again over [0, 1].
    fn halves(&self) -> (Self, Self) {
        let (mut left, mut right) = (*self, *self);
        for level in 1..=self.degree {
            left.coefficients[level - 1] = right.coefficients[0];
            for k in 0..=self.degree - level {
                right.coefficients[k] = 0.5 * (right.coefficients[k] + right.coefficients[k + 1]);
            }
        }
        left.coefficients[self.degree] = right.coefficients[0];
        (left, right)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The polynomial whose slope has these roots, from the slope's product form.
    fn with_slope_roots(roots: &[f64]) -> Bernstein {
        // Multiply (x - root) into Bernstein coefficients of the slope, then integrate.
        let mut slope = vec![1.0];
        for root in roots {
            let n = slope.len();
            let scaled: Vec<f64> = (0..=n)
                .map(|k| {
                    let share = k as f64 / n as f64;
                    let from = if k > 0 { share * slope[k - 1] * (1.0 - root) } else { 0.0 };
                    let to = if k < n { (1.0 - share) * slope[k] * -root } else { 0.0 };
                    from + to
                })
                .collect();
            slope = scaled;
        }
        let mut coefficients = [0.0; WIDTH];
        for (k, slope) in slope.iter().enumerate() {
            coefficients[k + 1] = coefficients[k] + slope / slope_count(roots);
        }
        Bernstein { degree: roots.len() + 1, coefficients }
    }

    fn slope_count(roots: &[f64]) -> f64 {
        (roots.len() + 1) as f64
    }

    fn found(polynomial: &Bernstein) -> Vec<f64> {
        let mut all = Vec::new();
        polynomial.stationary(|x| all.push(x));
        all.sort_by(f64::total_cmp);
        all
    }

    #[test]
    fn every_stationary_point_inside_is_found_once() {
        for roots in [vec![0.25], vec![0.1, 0.5, 0.9], vec![0.3, 0.300_1], vec![0.2, 0.4, 0.5, 0.6, 0.8]] {
            let got = found(&with_slope_roots(&roots));
            assert_eq!(got.len(), roots.len(), "{got:?} {roots:?}");
            for (got, want) in got.iter().zip(&roots) {
                assert!((got - want).abs() < 1e-11, "{got} {want}");
            }
        }
    }

    #[test]
    fn stationary_points_outside_are_not_reported() {
        assert_eq!(found(&with_slope_roots(&[-0.1, 1.2, 1.5])), Vec::<f64>::new());
    }

    #[test]
    fn a_double_root_and_a_constant_end_quickly() {
        assert!(found(&with_slope_roots(&[1.0 / 3.0, 1.0 / 3.0])).len() <= 2);
        assert_eq!(found(&Bernstein { degree: 6, coefficients: [0.7; WIDTH] }), Vec::<f64>::new());
    }
}
