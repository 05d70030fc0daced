//! How fast a plan of free shape may be, as it is.

use crate::plan::{Limit, Margin, PlanEvaluation, Setup};

/// Halvings of what a plan that touches no limit may be quickened by, and the distance to a limit that is worth them.
const HALVINGS: usize = 12;
const WORTH: f64 = 1e-4;

/// The plan, as much faster as its limits allow all of it.
pub(super) fn quickened(setup: &Setup, plan: PlanEvaluation) -> PlanEvaluation {
    let timed = plan.margins.iter().filter(|margin| margin.limit != Limit::Position);
    let least = timed.map(factor).fold(0.0, f64::max);
    if !(0.1..1.0 - WORTH).contains(&least) {
        return plan;
    }
    let scaled = |by: f64| plan.paced(setup, by).filter(|plan| plan.broken().is_empty());
    let (mut best, mut range) = (None, [least, 1.0]);
    for _ in 0..HALVINGS {
        let by = 0.5 * (range[0] + range[1]);
        match scaled(by) {
            Some(faster) => (best, range[1]) = (Some(faster), by),
            None => range[0] = by,
        }
    }
    best.unwrap_or(plan)
}

/// How much slower a plan is at the limit that it breaks: enough for rates, of torques and forces only a beginning.
pub(super) fn factor(margin: &Margin) -> f64 {
    margin.slower().unwrap_or(margin.share)
}
