//! The quadratic programme of one step, solved by Clarabel.

use crate::math::{Columns, quadratic_programme};

/// Price of breaking the linearised constraints, against weights of the merit that sum to one.
pub(super) const PRICE: f64 = 20.0;

/// A step d that lessens 1/2 d'Bd + g'd + PRICE * t within a box, with every `c + J d <= t` and
/// t >= 0.
#[derive(Clone, Copy)]
pub(super) struct Step<'a> {
    /// B, positive definite, `[n][n]`.
    pub(super) hessian: &'a [f64],
    /// g, `[n]`.
    pub(super) gradient: &'a [f64],
    /// c, `[m]`.
    pub(super) constraint: &'a [f64],
    /// J, `[m][n]`.
    pub(super) jacobian: &'a [f64],
    /// Least and largest of each element of d; the least below the largest.
    pub(super) bounds: &'a [(f64, f64)],
}

/// Solution of a step.
pub(super) struct Solution {
    /// d, `[n]`.
    pub(super) step: Vec<f64>,
    /// Multipliers of the constraints, not negative, `[m]`.
    pub(super) multiplier: Vec<f64>,
    /// How far the linearised constraints remain broken, t.
    pub(super) broken: f64,
}

impl Step<'_> {
    /// `None` if the solver finds no step.
    pub(super) fn solve(&self) -> Option<Solution> {
        let (n, m) = (self.gradient.len(), self.constraint.len());
        // Column j of P holds rows 0..=j of B; t has a little curvature of its own.
        let mut p = Columns::default();
        for j in 0..n {
            p.column((0..=j).map(|i| (i, self.hessian[i * n + j])));
        }
        p.column(std::iter::once((n, 1e-6)));
        let mut a = Columns::default();
        for j in 0..n {
            let rows = (0..m).map(|i| (i, self.jacobian[i * n + j]));
            a.column(rows.chain([(m + j, 1.0), (m + n + j, -1.0)]));
        }
        a.column((0..m).map(|i| (i, -1.0)).chain([(m + 2 * n, -1.0)]));
        let b: Vec<f64> = (self.constraint.iter().map(|c| -c))
            .chain(self.bounds.iter().map(|bound| bound.1))
            .chain(self.bounds.iter().map(|bound| -bound.0))
            .chain([0.0])
            .collect();
        let q: Vec<f64> = self.gradient.iter().copied().chain([PRICE]).collect();
        let (x, multiplier) = quadratic_programme(p, &q, a, &b)?;
        Some(Solution {
            step: x[..n].iter().zip(self.bounds).map(|(d, (low, high))| d.clamp(*low, *high)).collect(),
            multiplier: multiplier[..m].to_vec(),
            broken: x[n].max(0.0),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Least of 1/2 |d - (2, 1)|².
    fn towards(constraint: &[f64], jacobian: &[f64], bound: f64) -> Solution {
        let step = Step {
            hessian: &[1.0, 0.0, 0.0, 1.0],
            gradient: &[-2.0, -1.0],
            constraint,
            jacobian,
            bounds: &[(-bound, bound); 2],
        };
        step.solve().unwrap()
    }

    #[test]
    fn a_step_stops_at_the_box_and_at_constraints_whose_multipliers_are_the_slope_left() {
        let free = towards(&[], &[], 5.0);
        assert!((free.step[0] - 2.0).abs() < 1e-6 && (free.step[1] - 1.0).abs() < 1e-6);
        let boxed = towards(&[], &[], 0.5);
        assert!((boxed.step[0] - 0.5).abs() < 1e-6 && (boxed.step[1] - 0.5).abs() < 1e-6);
        // d0 <= 1.
        let held = towards(&[-1.0], &[1.0, 0.0], 5.0);
        assert!((held.step[0] - 1.0).abs() < 1e-6 && (held.step[1] - 1.0).abs() < 1e-6);
        assert!((held.multiplier[0] - 1.0).abs() < 1e-5 && held.broken < 1e-6);
    }

    #[test]
    fn constraints_that_contradict_each_other_are_broken_as_little_as_possible() {
        // d0 <= -1 and d0 >= 1.
        let torn = towards(&[1.0, 1.0], &[1.0, 0.0, -1.0, 0.0], 5.0);
        assert!((torn.broken - 1.0).abs() < 1e-3, "{}", torn.broken);
        assert!(torn.step[0].abs() < 1e-2);
    }
}
