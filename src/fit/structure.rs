//! What beside a dead band, a lag and a loop the data show. One part stands in for another that is not there yet, so that which explains
//! more comes first.

use super::{
    beyond::beyond,
    estimate::{Estimate, Problem, Workspace},
    integral::{limited, without},
    parameters::Integral,
    play::played,
    swing::swinging,
};

/// The estimate with the parts that the data show, and no integral that they do not.
pub(super) fn structured(problem: &mut Problem, found: Estimate, workspace: &mut Workspace) -> Estimate {
    let mut found = simpler(problem, found, workspace);
    loop {
        let mut parts = vec![beyond(problem, &found, workspace), played(problem, &found, workspace)];
        if !problem.explains(&found.x, workspace) {
            parts.push(limited(problem, &found, workspace));
            parts.push(swinging(problem, &found, workspace));
        }
        let cost = |(with, shown): (Estimate, _)| {
            let other = Problem { shown, ..problem.clone() };
            (other.cost_at(&with.x, found.scale_rad, workspace), with, shown)
        };
        let best = parts.into_iter().flatten().map(cost).min_by(|a, b| a.0.total_cmp(&b.0));
        let Some((_, with, shown)) = best else { break };
        problem.shown = shown;
        found = simpler(problem, with, workspace);
    }
    found
}

/// Without an integral, if the data do not show one.
fn simpler(problem: &mut Problem, found: Estimate, workspace: &mut Workspace) -> Estimate {
    let less =
        if problem.shown.integral == Integral::Free { without(problem, &found, workspace) } else { None };
    less.map_or(found, |less| {
        problem.shown.integral = Integral::None;
        less
    })
}
