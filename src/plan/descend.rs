//! The best timing near a timing: sequential quadratic programming in the logarithms of the
//! intervals, in which objectives and loads of a motion are nearly linear.
//!
//! Powell's damped update (1978, doi:10.1007/BFb0067703), a trust region on the steps, the exact
//! penalty of the most broken constraint, and second-order corrections (Fletcher 1982,
//! doi:10.1007/BFb0120951).

use super::{
    Evaluator, Setup, Timing,
    goal::Goal,
    quadratic::{PRICE, Solution, Step},
    tangent::{Cuts, Point, Slopes},
};
use crate::math::dot;

/// First steps from far off, and from a plan that is nearly best.
pub(super) const FAR_OFF: f64 = 0.4;
pub(super) const NEARLY: f64 = 0.05;

/// Gains of merit that are worth going on for: of an end of the front, of a plan among many.
pub(super) const FINE: f64 = 1e-6;
pub(super) const COARSE: f64 = 2e-4;

/// Where a descent ended.
#[derive(Debug, Clone)]
pub(super) struct Descended {
    /// At worst the start; `None` if that is no motion.
    pub(super) timing: Option<Timing>,
    pub(super) evaluations: u64,
    /// Whether it ended because there was no more to gain.
    pub(super) settled: bool,
}

/// A step shorter than this ends a descent.
const SHORT: f64 = 1e-6;
const LONGEST: f64 = 2.0;
/// Shares of the gain expected: below the first a step was too long, above the second it may grow.
const POOR: f64 = 0.1;
const GOOD: f64 = 0.7;
/// A refused step no longer than this may have met a kink.
const KINK: f64 = 0.05;
/// A step that breaks constraints for this share of its gain is corrected.
const CORRECT: f64 = 0.1;

/// Descends from `start_s`, times of movement, s; those beyond the setup's bounds are moved to them.
pub(super) fn descend(setup: &Setup, evaluator: &mut Evaluator, start_s: &[f64], goal: &Goal) -> Descended {
    let mut descent = Descent { setup, evaluator, goal, evaluations: 0 };
    let timing = descent.run(start_s);
    let (timing, settled) = timing.map_or((None, false), |(timing, settled)| (Some(timing), settled));
    Descended { timing, evaluations: descent.evaluations, settled }
}

struct Descent<'a> {
    setup: &'a Setup,
    evaluator: &'a mut Evaluator,
    goal: &'a Goal,
    evaluations: u64,
}

impl Descent<'_> {
    fn run(&mut self, start_s: &[f64]) -> Option<(Timing, bool)> {
        let bounds = self.setup.interval_s.map(f64::ln);
        let mut here = self.look(start_s.iter().map(|s| s.ln().clamp(bounds[0], bounds[1])).collect())?;
        let n = here.x.len();
        let Some(mut slopes) = self.slopes(&here) else { return Some((here.timing, false)) };
        let mut hessian = identity(n);
        let (mut trust, enough) = (self.goal.trust, self.goal.enough);
        let mut cuts = Cuts::default();
        // A step, its correction, and the slopes where it leads.
        while self.evaluations + 2 + n as u64 <= self.goal.evaluations {
            let rows = slopes.within(&here, trust);
            let (constraint, jacobian) = slopes.rows(&here, &rows, &cuts);
            let reach: Vec<(f64, f64)> =
                here.x.iter().map(|x| ((bounds[0] - x).max(-trust), (bounds[1] - x).min(trust))).collect();
            let step = Step {
                hessian: &hessian,
                gradient: &slopes.gradient,
                constraint: &constraint,
                jacobian: &jacobian,
                bounds: &reach,
            };
            let Some(Solution { step: d, multiplier, broken }) = step.solve() else { break };
            let length = longest(&d);
            let model = dot(&slopes.gradient, &d) + 0.5 * curved(&hessian, &d) + PRICE * broken;
            let expected = here.broken() - model;
            if length < SHORT || expected < 0.1 * enough {
                return Some((here.timing, true));
            }
            let Some((there, d)) = self.step(&here, &step, &rows, d, expected) else {
                trust = 0.5 * length;
                continue;
            };
            let gain = here.worth() - there.worth();
            if gain < POOR * expected {
                trust = 0.5 * length;
            } else if gain > GOOD * expected {
                trust = trust.max(2.0 * length).min(LONGEST);
            }
            if gain <= 0.0 && length > KINK {
                continue;
            }
            if trust < SHORT {
                return Some((here.timing, true));
            }
            let Some(next) = self.slopes(&there) else { break };
            if gain <= 0.0 {
                cuts.add(&there, &next, &d);
                continue;
            }
            let change = next.lagrangian(&rows, &multiplier).into_iter();
            let change: Vec<f64> = change
                .zip(slopes.lagrangian(&rows, &multiplier))
                .map(|(after, before)| after - before)
                .collect();
            update(&mut hessian, &d, &change);
            let settled = gain < enough && there.broken() < enough;
            (here, slopes, cuts) = (there, next, Cuts::default());
            if settled {
                return Some((here.timing, true));
            }
        }
        Some((here.timing, false))
    }

    /// Where a step leads, and the step: if it breaks constraints, one that takes them as they are
    /// there and their slopes as they are here. Without that, steps along bent constraints are refused.
    fn step(
        &mut self,
        here: &Point,
        step: &Step<'_>,
        rows: &[usize],
        d: Vec<f64>,
        expected: f64,
    ) -> Option<(Point, Vec<f64>)> {
        let at = |d: &[f64]| here.x.iter().zip(d).map(|(x, d)| x + d).collect();
        let there = self.look(at(&d))?;
        if there.broken() <= CORRECT * expected {
            return Some((there, d));
        }
        let bent = rows.iter().zip(step.jacobian.chunks_exact(d.len()));
        let bent = bent.map(|(&i, row)| there.constraint[i] - dot(row, &d));
        let bent: Vec<f64> = bent.chain(step.constraint[rows.len()..].iter().copied()).collect();
        let Some(Solution { step: corrected, .. }) = (Step { constraint: &bent, ..*step }).solve() else {
            return Some((there, d));
        };
        match self.look(at(&corrected)) {
            Some(second) if second.worth() < there.worth() => Some((second, corrected)),
            _ => Some((there, d)),
        }
    }

    fn look(&mut self, x: Vec<f64>) -> Option<Point> {
        self.evaluations += 1;
        Point::look(self.setup, self.evaluator, self.goal, x)
    }

    fn slopes(&mut self, at: &Point) -> Option<Slopes> {
        self.evaluations += at.x.len() as u64;
        Slopes::of(self.setup, self.evaluator, self.goal, at)
    }
}

fn identity(n: usize) -> Vec<f64> {
    (0..n * n).map(|i| if i % (n + 1) == 0 { 1.0 } else { 0.0 }).collect()
}

fn longest(d: &[f64]) -> f64 {
    d.iter().fold(0.0, |most, d| most.max(d.abs()))
}

fn times(matrix: &[f64], d: &[f64]) -> Vec<f64> {
    matrix.chunks_exact(d.len()).map(|row| dot(row, d)).collect()
}

/// d'Bd.
fn curved(matrix: &[f64], d: &[f64]) -> f64 {
    dot(&times(matrix, d), d)
}

/// Powell's update, which keeps B positive definite.
fn update(hessian: &mut [f64], step: &[f64], change: &[f64]) {
    let bs = times(hessian, step);
    let (sbs, sy) = (dot(step, &bs), dot(step, change));
    if sbs < 1e-18 {
        return;
    }
    let theta = if sy >= 0.2 * sbs { 1.0 } else { 0.8 * sbs / (sbs - sy) };
    let r: Vec<f64> = change.iter().zip(&bs).map(|(y, b)| theta * y + (1.0 - theta) * b).collect();
    let sr = dot(step, &r);
    let n = step.len();
    for i in 0..n {
        for j in 0..n {
            hessian[i * n + j] += r[i] * r[j] / sr - bs[i] * bs[j] / sbs;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{super::goal::Merit, *};
    use crate::{
        arm::Arm,
        task::{Ceilings, Objective, Task},
    };

    fn task_1() -> Setup {
        let task = Task::parse(include_str!("../../sample-logs/tasks/task-1.toml")).unwrap();
        Setup::new(&task, Arm::sample().unwrap()).unwrap()
    }

    const QUICK: Goal = Goal {
        merit: Merit::alone(Objective::Duration),
        ceilings: Ceilings::NONE,
        evaluations: 1000,
        trust: FAR_OFF,
        enough: FINE,
    };

    #[test]
    fn every_start_leads_to_one_fastest_plan_and_no_limit_is_broken_there() {
        let setup = task_1();
        let mut evaluator = Evaluator::new(&setup);
        let mut durations_s = Vec::new();
        for start_s in [[1.0; 5], [3.0; 5], [10.0; 5], [1.5, 5.0, 2.0, 6.0, 1.5]] {
            let end = descend(&setup, &mut evaluator, &start_s, &QUICK);
            assert!(end.settled, "from {start_s:?}");
            let timing = end.timing.unwrap();
            assert!(timing.violation < 1e-5, "{}", timing.violation);
            durations_s.push(timing.objectives[Objective::Duration]);
        }
        for duration_s in &durations_s {
            assert!((duration_s - 12.42065).abs() < 1e-3, "{durations_s:?}");
        }
    }

    #[test]
    fn a_descent_keeps_its_ceilings_and_its_budget() {
        let setup = task_1();
        let mut evaluator = Evaluator::new(&setup);
        let goal = Goal {
            merit: Merit::alone(Objective::RmsJerk),
            ceilings: Ceilings::NONE.with(Objective::Duration, 30.0),
            evaluations: 60,
            ..QUICK
        };
        let end = descend(&setup, &mut evaluator, &[5.0; 5], &goal);
        assert!(end.evaluations <= 60);
        let objectives = end.timing.unwrap().objectives;
        assert!((objectives[Objective::Duration] - 30.0).abs() < 1e-3, "{objectives:?}");
    }
}
