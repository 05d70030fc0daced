//! Whether a limit shows: a limit that the joint never reached must not be reported as a number.

use super::{
    estimate::{Estimate, Problem, Workspace},
    interval::{QUANTILE, discrepancy::LIMIT},
    parameters::{LIMITS, Priors, SHARED},
    robust::{cost, inefficiency},
};

/// 95 % quantile of a chi-squared variable with one degree of freedom.
const THRESHOLD: f64 = 3.84;

/// A joint shows a limit only if it was asked for this many times as much: a model of another form
/// than the machine's may gain by clipping anywhere.
pub(super) const ASKED: f64 = 1.3;

/// Fastest growing and shrinking of the angle if nothing limited the joint.
fn fastest(problem: &Problem, found: &Estimate, workspace: &mut Workspace) -> [f64; 2] {
    let mut free = problem.clone();
    free.shown.limits = [false; 4];
    let model = free.model(&found.x);
    let runs = problem.runs.iter().zip(found.x.iter().skip(SHARED));
    runs.fold([0.0; 2], |[up, down], (run, integral)| {
        workspace.simulate(&model, run, Priors::integral_rad_s(*integral));
        let [faster, slower] = workspace.fastest();
        [up.max(faster), down.max(slower)]
    })
}

/// Which of the limits the data show.
///
/// The cost without a limit must exceed the cost with it by more than chance; both are divided by the statistical
/// inefficiency, and the cost without comes from a fit of its own. A limit whose interval ends below what was
/// `reached` is none.
pub(super) fn seen(
    problem: &Problem,
    found: &Estimate,
    reached: [f64; 4],
    workspace: &mut Workspace,
) -> [bool; 4] {
    let mut residuals = Vec::new();
    let data = |residuals: &[f64]| residuals.iter().map(|r| cost(r / found.scale_rad)).sum::<f64>();
    problem.residuals(&found.x, workspace, &mut residuals);
    let (with, kappa) = (data(&residuals), inefficiency(&residuals));
    let unlimited = fastest(problem, found, workspace);
    let mut seen = problem.shown.limits;
    for limit in (0..problem.shown.limits.len()).filter(|&limit| problem.shown.limits[limit]) {
        let mut without = problem.clone();
        without.shown.limits[limit] = false;
        without.residuals(&found.x, workspace, &mut residuals);
        let mut shows = 2.0 * (data(&residuals) - with) / kappa > THRESHOLD;
        if shows {
            let refitted = without.descend(found.x.clone(), 10, workspace);
            without.residuals(&refitted.x, workspace, &mut residuals);
            shows = 2.0 * (data(&residuals) - with) / kappa > THRESHOLD;
        }
        let value = problem.priors.of(LIMITS + limit).value(found.x[LIMITS + limit]);
        let sent = problem.runs.iter().map(|run| run.asked[limit]).fold(0.0, f64::max);
        // What the loop makes of what is sent may be slower than that.
        let asked = unlimited.get(limit).map_or(sent, |speed| sent.min(*speed));
        let highest = value * (QUANTILE * LIMIT[limit]).exp();
        seen[limit] &= shows && asked > ASKED * value && highest >= reached[limit];
    }
    seen
}
