//! Whether a limit shows: a limit that the joint never reached must not be reported as a number.

use super::{
    estimate::{Estimate, Problem, Room},
    parameters::SHARED,
    robust::{cost, inefficiency},
};

/// 95 % quantile of a chi-squared variable with one degree of freedom.
const THRESHOLD: f64 = 3.84;

/// Which of the limits the data show.
///
/// The cost without a limit must exceed that with it by more than chance, both scaled down by how
/// many residuals tell as much as one independent one; the cost without is that of a fit of its own.
pub(super) fn seen(problem: &Problem, found: &Estimate, room: &mut Room) -> [bool; 4] {
    let mut residuals = Vec::new();
    let data = |residuals: &[f64]| residuals.iter().map(|r| cost(r / found.scale_rad)).sum::<f64>();
    problem.residuals(&found.x, room, &mut residuals);
    let (with, kappa) = (data(&residuals), inefficiency(&residuals));
    let mut seen = problem.seen;
    for limit in 0..seen.len() {
        let mut without = problem.clone();
        without.seen[limit] = false;
        without.residuals(&found.x, room, &mut residuals);
        let mut shows = 2.0 * (data(&residuals) - with) / kappa > THRESHOLD;
        if shows {
            let refitted = without.descend(found.x.clone(), 10, room);
            without.residuals(&refitted.x, room, &mut residuals);
            shows = 2.0 * (data(&residuals) - with) / kappa > THRESHOLD;
        }
        seen[limit] &= shows && found.x.len() > SHARED;
    }
    seen
}
