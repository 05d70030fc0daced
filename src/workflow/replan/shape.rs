//! New plans in a free shape: smoother within the time, jerk and power that are allowed, or within them at all.

use rayon::prelude::*;

use crate::{
    plan::{Choice, PlanError, PlanEvaluation, Setup, Timing, shape},
    task::{Ceilings, Objective},
    workflow::plan::Shaping,
};

/// How much longer a timing may take than is allowed where a free shape makes up for it: the fastest shape takes a tenth to a
/// fifth less time than the fastest timing.
const SLOWER: f64 = 1.25;

/// Ceilings for timings that a free shape brings within `ceilings`.
pub(super) fn roomy(ceilings: Ceilings) -> Ceilings {
    ceilings.with(Objective::Duration, SLOWER * ceilings[Objective::Duration])
}

/// Plans of timings, and, if it is free, each in a smoother shape and that of the last one's times; without those that stay beyond
/// the ceilings.
///
/// # Errors
///
/// [`PlanError`] of timings of another task.
pub(super) fn shaped(
    setup: &Setup,
    best: &[Timing],
    (start, ceilings): (Option<&[f64]>, &Ceilings),
    shaping: Shaping,
) -> Result<Vec<PlanEvaluation>, PlanError> {
    let of = |interval_s: &[f64]| PlanEvaluation::of(setup, &setup.times_s(interval_s));
    let Shaping::Free(pieces) = shaping else {
        let others = best.iter().filter(|timing| start != Some(timing.interval_s.as_slice()));
        return others.map(|timing| of(&timing.interval_s)).collect();
    };
    let mut all = best.to_vec();
    if let Some(start) = start {
        let PlanEvaluation { objectives, violation, .. } = of(start)?;
        all.push(Timing { interval_s: start.to_vec(), objectives, violation });
    }
    let one = |timing: Timing| -> Result<Vec<PlanEvaluation>, PlanError> {
        let by_times =
            if start == Some(timing.interval_s.as_slice()) { None } else { Some(of(&timing.interval_s)?) };
        let smoother = shape(setup, &Choice::smoother(timing, ceilings), ceilings, pieces);
        Ok(by_times.into_iter().chain(smoother.ok().map(|found| found.evaluation)).collect())
    };
    let made: Vec<Vec<PlanEvaluation>> = all.into_par_iter().map(one).collect::<Result<_, _>>()?;
    let kept = |plan: &PlanEvaluation| plan.broken().is_empty() && plan.objectives.within(ceilings);
    Ok(made.into_iter().flatten().filter(kept).collect())
}
