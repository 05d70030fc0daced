//! What logs hold of a plan beside the motion that they share.

use super::ReplanFailure;
use crate::series::{Series, moves_beside_s, moving_s};

/// What a log holds of its plan beside the motion that it shares with others, s from the start of that.
pub(super) struct Held {
    log: String,
    span_s: [f64; 2],
    /// Motion before and after it.
    moves_s: [Option<f64>; 2],
}

impl Held {
    pub(super) fn of(log: &str, planned: &Series, plan: &Series, starts_s: f64) -> Option<Self> {
        let motion_s = moving_s(plan)?.map(|at_s| starts_s + at_s);
        let span_s = planned.span_s()?.map(|at_s| at_s - starts_s);
        let moves_s = moves_beside_s(planned, motion_s).map(|at_s| Some(at_s? - starts_s));
        Some(Self { log: log.to_owned(), span_s, moves_s })
    }

    /// Whether it has ended, or had not begun, when the plan of another log moves on: whether its own would have nobody knows.
    pub(super) fn check(&self, other: &Self) -> Result<(), ReplanFailure> {
        let [before_s, after_s] = other.moves_s;
        let ends = after_s.is_some_and(|at_s| self.span_s[1] < at_s);
        if ends || before_s.is_some_and(|at_s| self.span_s[0] > at_s) {
            return Err(ReplanFailure::InRest { log: self.log.clone(), other: other.log.clone(), ends });
        }
        Ok(())
    }
}
