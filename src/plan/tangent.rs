//! Values and slopes of merit and constraints at a timing.

use super::{Evaluator, KEPT_SHARE, Setup, Timing, goal::Goal, quadratic::PRICE};
use crate::math::dot;

/// Step of the difference quotients, in logarithms.
const DIFFERENCE: f64 = 1e-6;
/// Limits are aimed at from within by this share, so that rounding does not break them.
const WITHIN: f64 = 1e-6;
/// Constraints further from their limit than this, in logarithms, are left out of a step.
const FAR: f64 = 0.7;
/// Constraints nearer than this to their limit where a step was refused become cuts.
const CUT: f64 = 0.02;

/// A timing with its values.
pub(super) struct Point {
    /// Logarithms of the intervals in s.
    pub(super) x: Vec<f64>,
    pub(super) timing: Timing,
    pub(super) merit: f64,
    /// Logarithms of shares of ceilings, then of the limits' peaks; above 0 they are broken.
    pub(super) constraint: Vec<f64>,
}

impl Point {
    /// `None` if it is no motion.
    pub(super) fn look(setup: &Setup, evaluator: &mut Evaluator, goal: &Goal, x: Vec<f64>) -> Option<Self> {
        let [low, high] = setup.interval_s;
        let interval_s: Vec<f64> = x.iter().map(|x| x.exp().clamp(low, high)).collect();
        let objectives = evaluator.evaluate_peaks(setup, &interval_s)?;
        let f = objectives.plan();
        if !f.iter().all(|f| f.is_finite() && *f >= 0.0) {
            return None;
        }
        let ceilings = f
            .iter()
            .zip(goal.ceilings.plan())
            .map(|(f, ceiling)| (f / ceiling.max(f64::MIN_POSITIVE)).max(1e-6).ln());
        // What stays at the end of its range is at it and no nearer, whatever the times.
        let limit = |share: &f64| {
            if (share - 1.0).abs() < KEPT_SHARE - 1.0 { 0.0 } else { share.clamp(1e-6, 1e6).ln() + WITHIN }
        };
        let limits = evaluator.peaks.iter().map(limit);
        let constraint = ceilings.chain(limits).collect();
        let timing = Timing { interval_s, objectives, violation: evaluator.violation() };
        Some(Self { x, timing, merit: goal.merit.of(&objectives), constraint })
    }

    /// Merit and penalty.
    pub(super) fn worth(&self) -> f64 {
        self.merit + self.broken()
    }

    /// The price of the most broken constraint.
    pub(super) fn broken(&self) -> f64 {
        PRICE * self.constraint.iter().fold(0.0, |most: f64, c| most.max(*c))
    }
}

/// Slopes of merit and constraints.
pub(super) struct Slopes {
    pub(super) gradient: Vec<f64>,
    /// `[constraint][variable]`.
    jacobian: Vec<f64>,
}

impl Slopes {
    /// By forward differences, backward at the longest interval.
    pub(super) fn of(setup: &Setup, evaluator: &mut Evaluator, goal: &Goal, at: &Point) -> Option<Self> {
        let (n, most) = (at.x.len(), setup.interval_s[1].ln());
        let mut gradient = vec![0.0; n];
        let mut jacobian = vec![0.0; at.constraint.len() * n];
        for j in 0..n {
            let mut x = at.x.clone();
            let h = if x[j] + DIFFERENCE > most { -DIFFERENCE } else { DIFFERENCE };
            x[j] += h;
            let beside = Point::look(setup, evaluator, goal, x)?;
            gradient[j] = (beside.merit - at.merit) / h;
            for (i, (c, c0)) in beside.constraint.iter().zip(&at.constraint).enumerate() {
                jacobian[i * n + j] = (c - c0) / h;
            }
        }
        Some(Self { gradient, jacobian })
    }

    fn row(&self, i: usize) -> &[f64] {
        let n = self.gradient.len();
        &self.jacobian[i * n..][..n]
    }

    /// Constraints that a step of this length could reach.
    pub(super) fn within(&self, at: &Point, trust: f64) -> Vec<usize> {
        let reach = |i: usize| trust * self.row(i).iter().map(|slope| slope.abs()).sum::<f64>();
        let near = |&i: &usize| at.constraint[i] > -FAR && at.constraint[i] + reach(i) > 0.0;
        (0..at.constraint.len()).filter(near).collect()
    }

    /// Values and slopes of the constraints of a step: those chosen, then the cuts.
    pub(super) fn rows(&self, at: &Point, chosen: &[usize], cuts: &Cuts) -> (Vec<f64>, Vec<f64>) {
        let constraint = chosen.iter().map(|&i| at.constraint[i]).chain(cuts.constraint.iter().copied());
        let own = chosen.iter().flat_map(|&i| self.row(i));
        (constraint.collect(), own.chain(&cuts.jacobian).copied().collect())
    }

    /// Gradient of merit and chosen constraints by their multipliers.
    pub(super) fn lagrangian(&self, chosen: &[usize], multiplier: &[f64]) -> Vec<f64> {
        let mut sum = self.gradient.clone();
        for (&i, m) in chosen.iter().zip(multiplier) {
            sum.iter_mut().zip(self.row(i)).for_each(|(sum, slope)| *sum += m * slope);
        }
        sum
    }
}

/// Constraints as they are where a step was refused: where two peaks take turns in being the
/// largest, the slopes of one side alone lead across the kink for ever.
#[derive(Default)]
pub(super) struct Cuts {
    /// Where the steps start from.
    constraint: Vec<f64>,
    jacobian: Vec<f64>,
}

impl Cuts {
    /// Takes what is near its limit where a step ended.
    pub(super) fn add(&mut self, there: &Point, slopes: &Slopes, step: &[f64]) {
        for (i, c) in there.constraint.iter().enumerate().filter(|(_, c)| **c > -CUT) {
            self.constraint.push(c - dot(slopes.row(i), step));
            self.jacobian.extend_from_slice(slopes.row(i));
        }
    }
}
