//! Where a search starts: the fastest plan, and for a row of durations the smoothest plan, the one
//! of least power, and those between.
//!
//! At a given duration the front is a short curve from the smoothest plan to that of least power;
//! while no limit binds, its shapes hardly depend on the duration. So a few descents and what lies
//! between them cover the front.

use super::{
    Evaluator, Setup, Timing,
    descend::{COARSE, Descended, FAR_OFF, FINE, NEARLY, descend},
    goal::{Goal, Merit},
};
use crate::{
    task::{Ceilings, Objective, Weights},
    threads,
};
/// Weight of power against jerk, both as logarithms, on each curve. Power moves only near 1; at 1 jerk
/// would be left to chance.
const CURVES: [f64; 5] = [0.0, 0.5, 0.75, 0.92, 0.985];
/// Durations as multiples of the fastest, where limits bind and shapes change.
const NEAR_FASTEST: [f64; 6] = [1.03, 1.08, 1.16, 1.3, 1.5, 1.9];
/// Durations as shares of the slowest, where intervals reach their longest.
const NEAR_SLOWEST: [f64; 6] = [0.5, 0.61, 0.72, 0.82, 0.91, 0.98];
/// Hundredths of the budget: for the fastest plan, for the curves, for the smoothest plan
/// and that of least power, for what lies between.
const FASTEST: u64 = 8;
const DESCENTS: u64 = 22;
const ENDS: u64 = 3;
const BETWEEN: u64 = 16;
/// Intervals from which on the descents to the fastest plan get up to so many steps, of half of the budget at most.
const MANY: usize = 24;
const MOST_STEPS: u64 = 200;
const HALF: u64 = 50;
/// Steps that a descent on a curve is worth starting with; the fewest durations of a curve.
const STEPS: u64 = 2;
const FEWEST: usize = 3;
/// More than this between the curves fill the front no better.
const MOST_BETWEEN: u64 = 800;

/// Plans to start from, feasible or not, and what they cost.
#[derive(Default)]
pub(super) struct Seeds {
    /// Where descents ended with no more to gain.
    pub(super) exact: Vec<Timing>,
    /// Where others ended, and what lies between.
    pub(super) rough: Vec<Timing>,
    pub(super) evaluations: u64,
    /// Whether the descent to the fastest plan ended because nothing was left to gain.
    pub(super) fastest_converged: bool,
}

/// Seeds for a search of `budget` evaluations, of which they take about a third.
pub(super) fn seeds(setup: &Setup, budget: u64) -> Seeds {
    let share = |hundredths: u64| budget / 100 * hundredths;
    let step = setup.interval_count() as u64 + 2;
    let mut seeds = Seeds::default();
    let mut evaluator = Evaluator::new(setup);
    // A step of a descent takes an evaluation an interval: of many, the share of few is no descent.
    let steps = if setup.interval_count() > MANY { (MOST_STEPS * step).min(share(HALF)) } else { 0 };
    let Some(fastest) = seeds.fastest(setup, &mut evaluator, share(FASTEST).max(steps)) else { return seeds };
    let mut durations_s = durations(setup, &fastest);
    let few = |durations: usize| share(DESCENTS) < STEPS * step * (CURVES.len() * durations) as u64;
    while durations_s.len() > FEWEST && few(durations_s.len()) {
        // The slowest stays.
        durations_s = durations_s.into_iter().rev().step_by(2).collect();
        durations_s.reverse();
    }
    let most = share(DESCENTS) / (CURVES.len() * durations_s.len()).max(1) as u64;
    let curves: Vec<Vec<Descended>> =
        threads::mapped(&CURVES, || (), |(), &power| curve(setup, &fastest, &durations_s, power, most));
    let curves: Vec<Vec<Timing>> = curves
        .into_iter()
        .map(|curve| curve.into_iter().filter_map(|end| seeds.take(end)).collect())
        .collect();
    let ends = [Objective::RmsJerk, Objective::RmsPower].into_iter().zip([curves.first(), curves.last()]);
    for (objective, curve) in ends {
        let Some(slowest) = curve.and_then(|curve| curve.last()) else { continue };
        let goal = Goal {
            merit: Merit::alone(objective),
            ceilings: Ceilings::NONE,
            evaluations: share(ENDS) / 2,
            trust: FAR_OFF,
            enough: FINE,
        };
        let end = descend(setup, &mut evaluator, &slowest.interval_s, &goal);
        seeds.take(end);
    }
    // All curves shrink to the fastest plan.
    let whole = curves.into_iter().map(|curve| std::iter::once(fastest.clone()).chain(curve).collect());
    seeds.fill(setup, &mut evaluator, &whole.collect::<Vec<_>>(), share(BETWEEN).min(MOST_BETWEEN));
    seeds
}

/// The fastest plan of a task by times alone, as far as the two descents from which a search starts find it; `None` where they end
/// in none that keeps all limits.
pub fn fastest(setup: &Setup, evaluations: u64) -> Option<Timing> {
    let mut evaluator = Evaluator::new(setup);
    let found = Seeds::default().fastest(setup, &mut evaluator, evaluations)?;
    (found.violation <= 0.0 && setup.keeps(&found.interval_s, &mut evaluator)).then_some(found)
}

impl Seeds {
    /// All of them.
    pub(super) fn all(&self) -> impl Iterator<Item = &Timing> {
        self.exact.iter().chain(&self.rough)
    }

    /// The fastest plan that two descents find.
    fn fastest(&mut self, setup: &Setup, evaluator: &mut Evaluator, evaluations: u64) -> Option<Timing> {
        let [low, high] = setup.interval_s;
        let n = setup.interval_count();
        let middle_s = (low * high).sqrt();
        let even = vec![middle_s; n];
        let smooth = Goal {
            merit: Merit::alone(Objective::RmsJerk),
            ceilings: Ceilings::NONE.with(Objective::Duration, setup.even_s(middle_s)),
            evaluations: evaluations / 8,
            trust: FAR_OFF,
            enough: FINE,
        };
        let shape = self.descend(setup, evaluator, &even, &smooth);
        let goal = |evaluations| Goal {
            merit: Merit::alone(Objective::Duration),
            ceilings: Ceilings::NONE,
            evaluations,
            trust: FAR_OFF,
            enough: FINE,
        };
        let from_even = descend(setup, evaluator, &even, &goal(evaluations / 3));
        let from_shape =
            shape.map(|shape| descend(setup, evaluator, &shape.interval_s, &goal(evaluations / 2)));
        let ends = std::iter::once(from_even).chain(from_shape).filter(|end| end.timing.is_some());
        let key = |end: &Descended| {
            end.timing.as_ref().map_or((f64::INFINITY, f64::INFINITY), |timing| {
                (timing.violation, timing.objectives[Objective::Duration])
            })
        };
        let ends: Vec<Descended> = ends.collect();
        let best = ends.iter().min_by(|a, b| {
            let (a, b) = (key(a), key(b));
            a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1))
        });
        self.fastest_converged = best.is_some_and(|best| best.settled);
        let fastest = best.and_then(|best| best.timing.clone());
        for end in ends {
            self.take(end);
        }
        fastest
    }

    fn descend(
        &mut self,
        setup: &Setup,
        evaluator: &mut Evaluator,
        start_s: &[f64],
        goal: &Goal,
    ) -> Option<Timing> {
        self.take(descend(setup, evaluator, start_s, goal))
    }

    /// Counts and keeps what a descent found.
    fn take(&mut self, found: Descended) -> Option<Timing> {
        self.evaluations += found.evaluations;
        let kept = if found.settled { &mut self.exact } else { &mut self.rough };
        kept.extend(found.timing.clone());
        found.timing
    }

    /// Plans between those of the curves, in the logarithms of duration and interval.
    fn fill(&mut self, setup: &Setup, evaluator: &mut Evaluator, curves: &[Vec<Timing>], count: u64) {
        let rows = curves.iter().map(Vec::len).min().unwrap_or(0);
        let across = curves.len();
        if rows < 2 || across < 2 {
            return;
        }
        // Into how many parts to cut the steps of the grid along the curves; across none.
        let down = usize::try_from(count).unwrap_or(usize::MAX) / across / (rows - 1);
        let down = down.max(1);
        for i in (0..=(rows - 1) * down).filter(|i| i % down != 0) {
            let (row, u) = (i / down, (i % down) as f64 / down as f64);
            for curve in curves {
                let between = curve[row].interval_s.iter().zip(&curve[row + 1].interval_s);
                let interval_s: Vec<f64> = between.map(|(a, b)| a * (b / a).powf(u)).collect();
                self.evaluations += 1;
                if let Some(objectives) = evaluator.evaluate(setup, &interval_s) {
                    self.rough.push(Timing { interval_s, objectives, violation: evaluator.violation() });
                }
            }
        }
    }
}

fn durations(setup: &Setup, fastest: &Timing) -> Vec<f64> {
    let first_s = fastest.objectives[Objective::Duration];
    let last_s = setup.even_s(setup.interval_s[1]);
    let near_fastest = NEAR_FASTEST.iter().map(|ratio| first_s * ratio);
    let mut durations_s: Vec<f64> = near_fastest.filter(|s| *s < NEAR_SLOWEST[0] * last_s).collect();
    let from_s = durations_s.last().copied().unwrap_or(first_s);
    durations_s.push((from_s * NEAR_SLOWEST[0] * last_s).sqrt());
    durations_s.extend(NEAR_SLOWEST.iter().map(|share| share * last_s));
    durations_s.retain(|s| *s > first_s);
    durations_s
}

/// The best plan of each duration by one weight of power, each started from the one before; the
/// slow ones first, where nothing binds.
fn curve(setup: &Setup, fastest: &Timing, durations_s: &[f64], power: f64, most: u64) -> Vec<Descended> {
    let mut evaluator = Evaluator::new(setup);
    let mut found = Vec::new();
    let mut last = fastest.clone();
    let dwell_s = setup.resting_s();
    let middle = durations_s.len() / 2;
    let order = (middle..durations_s.len()).chain((0..middle).rev());
    let mut first = None;
    for (step, i) in order.enumerate() {
        if i + 1 == middle {
            last = first.clone().unwrap_or(last);
        }
        let duration_s = durations_s[i];
        let ratio = (duration_s - dwell_s) / (last.objectives[Objective::Duration] - dwell_s);
        let start_s: Vec<f64> = last.interval_s.iter().map(|s| s * ratio).collect();
        let goal = Goal {
            merit: Merit::Logarithms(
                Weights::ZERO.with(Objective::RmsJerk, 1.0 - power).with(Objective::RmsPower, power),
            ),
            ceilings: Ceilings::NONE.with(Objective::Duration, duration_s),
            // The first has the longest way.
            evaluations: if step == 0 { 3 * most } else { most },
            trust: if step == 0 { FAR_OFF } else { NEARLY },
            enough: COARSE,
        };
        let mut descended = descend(setup, &mut evaluator, &start_s, &goal);
        // A plan that is slowed down evenly keeps its limits: a descent that lost them is no better.
        if descended.timing.as_ref().is_none_or(|timing| timing.violation > 0.0)
            && setup.has(&start_s)
            && let Some(objectives) = evaluator.evaluate(setup, &start_s)
            && evaluator.violation() <= 0.0
        {
            let timing = Timing { interval_s: start_s, objectives, violation: 0.0 };
            descended = Descended { timing: Some(timing), settled: false, ..descended };
        }
        if let Some(timing) = &descended.timing {
            last = timing.clone();
            first.get_or_insert_with(|| timing.clone());
        }
        found.push((i, descended));
    }
    found.sort_by_key(|(i, _)| *i);
    found.into_iter().map(|(_, descended)| descended).collect()
}
