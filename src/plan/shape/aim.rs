//! What a descent of the shape lessens.

use crate::{
    plan::Rule,
    task::{Objective, Objectives},
};

/// A weighted sum of logarithms to lessen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Aim {
    /// Weight of the duration; 0 if it is given.
    pub(super) duration: f64,
    /// Weight of the sum of the joints' root mean square jerks.
    pub(super) jerk: f64,
    /// The duration that the curve takes, dwells included, s; infinite if it is sought.
    pub(super) within_s: f64,
}

impl Aim {
    /// The fastest. The small weight of jerk settles joints that do not bound the duration.
    pub(super) const FASTEST: Self = Self { duration: 1.0, jerk: 1e-3, within_s: f64::INFINITY };

    /// The smoothest of a duration, s.
    pub(super) const fn smoothest(within_s: f64) -> Self {
        Self { duration: 0.0, jerk: 1.0, within_s }
    }

    /// Of a rule: faster if it asks for the fastest plan, else smoother at the duration of the plan that it chose.
    pub(super) fn of(rule: Rule, chosen: &Objectives) -> Self {
        match rule {
            Rule::Best(Objective::Duration) => Self::FASTEST,
            _ => Self::smoothest(chosen[Objective::Duration]),
        }
    }
}
