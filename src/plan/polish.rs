//! Descents from the plans found, each to one that is nowhere worse.

use super::{
    Evaluator, Setup, Timing,
    descend::{COARSE, Descended, NEARLY, descend},
    front::thinned,
    goal::{Goal, Merit},
};
use crate::{task::Objective, threads};

/// Shares of an objective that count as clearly better and as hardly worse.
const CLEAR: f64 = 0.005;
const HAIR: f64 = 0.001;
/// Steps that a descent from a plan found is worth starting with.
const STEPS: u64 = 4;
/// A plan is slowed down by less than this for a comparison.
const SLOWER: f64 = 1.1;

/// What descents from plans found.
pub(super) struct Polished {
    /// Where they ended with no more to gain.
    pub(super) exact: Vec<Timing>,
    /// Where others ended.
    pub(super) rough: Vec<Timing>,
    pub(super) evaluations: u64,
}

/// Descends from plans to ones that are nowhere worse, within so many evaluations altogether: from as
/// many as that suffices for, evenly over the front. What descents leave over goes to those that need
/// more.
pub(super) fn polish(setup: &Setup, plans: &[Timing], evaluations: u64) -> Polished {
    let step = setup.interval_count() as u64 + 2;
    let count = usize::try_from(evaluations / (STEPS * step)).unwrap_or(usize::MAX);
    let mut polished = Polished { exact: Vec::new(), rough: thinned(setup, plans, count), evaluations: 0 };
    loop {
        let left = evaluations.saturating_sub(polished.evaluations);
        let most = left / polished.rough.len().max(1) as u64;
        if most <= step || polished.rough.is_empty() {
            return polished;
        }
        let rough = std::mem::take(&mut polished.rough);
        let ends: Vec<Descended> = threads::mapped(
            &rough,
            || Evaluator::new(setup),
            |evaluator, timing| {
                let goal = Goal {
                    merit: Merit::even(),
                    ceilings: timing.objectives,
                    evaluations: most,
                    trust: NEARLY,
                    enough: COARSE,
                };
                descend(setup, evaluator, &timing.interval_s, &goal)
            },
        );
        for (start, end) in rough.into_iter().zip(ends) {
            polished.evaluations += end.evaluations;
            let kept = if end.settled { &mut polished.exact } else { &mut polished.rough };
            kept.push(end.timing.unwrap_or(start));
        }
    }
}

/// Whether a plan, slowed down to the duration of another, is clearly better in something and
/// nowhere worse by more than a hair. Slowing down lessens the integral of squared jerk with the fifth
/// power of the time of movement, and that of squared power, which is mostly gravity's, in proportion.
pub(super) fn beats(setup: &Setup, exact: &Timing, other: &Timing) -> bool {
    let dwell_s = setup.resting_s();
    let (a, b) = (exact.objectives, other.objectives);
    let ratio = (b[Objective::Duration] - dwell_s) / (a[Objective::Duration] - dwell_s);
    if exact.violation > 0.0 || !(1.0..SLOWER).contains(&ratio) {
        return false;
    }
    let share = (a[Objective::Duration] / b[Objective::Duration]).sqrt();
    let jerk = a[Objective::RmsJerk] * share * ratio.powf(-2.5) / b[Objective::RmsJerk];
    let power = a[Objective::RmsPower] * share * ratio.powf(-0.5) / b[Objective::RmsPower];
    jerk.max(power) < 1.0 + HAIR && jerk.min(power) < 1.0 - CLEAR
}
