//! New plans in a free shape: smoother within the time, jerk and power that are allowed, or within them at all.

use crate::{
    plan::{PlanError, PlanEvaluation, Setup, Timing, smoother},
    task::{Ceilings, Objective},
    threads,
    workflow::plan::Shaping,
};

/// How much longer a timing may take than is allowed where a free shape makes up for it: the fastest shape takes a tenth to a
/// fifth less time than the fastest timing.
const SLOWER: f64 = 1.25;

/// Ceilings for timings that a free shape brings within `ceilings`.
pub(super) fn roomy(ceilings: Ceilings) -> Ceilings {
    ceilings.with(Objective::Duration, SLOWER * ceilings[Objective::Duration])
}

/// Plans of timings but the one that is `known`, and, if it is free, each in a smoother shape and that of the last one's times;
/// without those that stay beyond the ceilings.
///
/// # Errors
///
/// [`PlanError`] of timings of another task.
pub(super) fn shaped(
    setup: &Setup,
    best: &[Timing],
    (start, known): (Option<&[f64]>, Option<&[f64]>),
    ceilings: &Ceilings,
    shaping: Shaping,
) -> Result<Vec<PlanEvaluation>, PlanError> {
    let of = |interval_s: &[f64]| PlanEvaluation::of(setup, &setup.times_s(interval_s));
    let is_new = |timing: &&Timing| known != Some(timing.interval_s.as_slice());
    let Shaping::Free(pieces) = shaping else {
        return best.iter().filter(is_new).map(|timing| of(&timing.interval_s)).collect();
    };
    let mut all = best.to_vec();
    if let Some(start) = start {
        let PlanEvaluation { objectives, violation, .. } = of(start)?;
        all.push(Timing { interval_s: start.to_vec(), objectives, violation });
    }
    let one = |timing: &Timing| -> Result<Vec<PlanEvaluation>, PlanError> {
        let by_times = Some(timing).filter(is_new).map(|timing| of(&timing.interval_s)).transpose()?;
        let smoother = smoother(setup, timing, ceilings, pieces).ok().map(|found| found.evaluation);
        Ok(by_times.into_iter().chain(smoother).collect())
    };
    let made = threads::mapped(&all, || (), |(), timing| one(timing)).into_iter();
    let made: Vec<Vec<PlanEvaluation>> = made.collect::<Result<_, _>>()?;
    let kept = |plan: &PlanEvaluation| plan.broken().is_empty() && plan.objectives.within(ceilings);
    Ok(made.into_iter().flatten().filter(kept).collect())
}
