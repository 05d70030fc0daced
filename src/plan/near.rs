//! The front where someone looks: exact plans of given times, and what a little more time buys.

use super::{Evaluator, Rule, Setup, Timing, choose, exact};
use crate::task::{Ceilings, Objective};

/// A little more time, as a share.
pub const MORE: f64 = 0.01;
/// Room for rounding at what is held, and below it.
const HELD: f64 = 1.0 + 2e-6;
const HELD_BACK: f64 = 2e-6;

/// By what share each objective but time falls at most where a plan may take [`MORE`] time, the others held.
pub fn bought(setup: &Setup, timing: &Timing) -> Vec<(Objective, f64)> {
    let longer_s = timing.objectives[Objective::Duration] * (1.0 + MORE);
    // The same plan, slower, is what a descent begins from at least.
    let rest_s = setup.resting_s();
    let slower = (longer_s * (1.0 - HELD_BACK) - rest_s) / (timing.objectives[Objective::Duration] - rest_s);
    let slower_s: Vec<f64> = timing.interval_s.iter().map(|s| s * slower).collect();
    let slower = (slower.is_finite() && setup.has(&slower_s))
        .then(|| exact::evaluated(setup, &mut Evaluator::new(setup), slower_s))
        .flatten()
        .filter(|slower| slower.violation <= 0.0);
    let from: Vec<Timing> = slower.into_iter().chain([timing.clone()]).collect();
    let one = |objective: Objective| {
        let held = Ceilings::NONE.map_plan(|k| timing.objectives[k] * HELD);
        let held = held.with(Objective::Duration, longer_s).with(objective, f64::INFINITY);
        let best = choose(setup, &from, &held, (Rule::Best(objective), None)).ok()?;
        Some((objective, 1.0 - best.timing.objectives[objective] / timing.objectives[objective]))
    };
    let others = Objective::OF_PLAN.iter().copied().filter(|k| *k != Objective::Duration);
    others.filter(|k| timing.objectives[*k] > 0.0).filter_map(one).collect()
}

/// What is made within the ceilings and round times around one, s; nothing for times that none keeps. `took_s`: its duration.
pub fn near<P>(
    ceilings: &Ceilings,
    around_s: f64,
    made: impl Fn(&Ceilings) -> Option<P>,
    took_s: impl Fn(&P) -> f64,
) -> Vec<(f64, P)> {
    let within = |within_s: f64| {
        let held = ceilings.with(Objective::Duration, within_s.min(ceilings[Objective::Duration]));
        Some((within_s, made(&held)?))
    };
    let mut plans: Vec<(f64, P)> = round_times_s(around_s).into_iter().filter_map(within).collect();
    // Slower than the task or its ceilings allow, all are one.
    plans.dedup_by(|later, earlier| took_s(&later.1) < took_s(&earlier.1) * (1.0 + 1e-6));
    plans
}

/// Seven times around one in steps of 1, 2 or 5 times a power of ten.
fn round_times_s(around_s: f64) -> Vec<f64> {
    let rough_s = around_s / 25.0;
    let power_s = 10.0_f64.powf(rough_s.log10().floor());
    let step_s = [1.0, 2.0, 5.0, 10.0].map(|k| k * power_s).into_iter().find(|step_s| *step_s >= rough_s);
    let step_s = step_s.unwrap_or(power_s);
    let middle = (around_s / step_s).round();
    // By hundredths of a second, so that 12.3 is the nearest number to it.
    let at = |k: i32| ((middle + f64::from(k)) * step_s * 1e4).round() / 1e4;
    (-3..=3).map(at).filter(|t_s| *t_s > 0.0).collect()
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use super::*;
    use crate::{arm::Arm, moea::Budget, plan::Search, task::Task};

    #[test]
    fn times_are_round_and_around() {
        assert_eq!(
            round_times_s(12.34),
            [10.5, 11.0, 11.5, 12.0, 12.5, 13.0, 13.5].map(|t: f64| t + 0.5)[..].to_vec()
        );
        assert_eq!(round_times_s(40.0), [34.0, 36.0, 38.0, 40.0, 42.0, 44.0, 46.0]);
    }

    /// Where no limit binds a plan is stretched: with rests of d squared jerk falls with T (T - d)^5.
    #[test]
    fn a_little_more_time_buys_what_the_closed_form_says_and_near_plans_are_on_it() {
        let task = Task::parse(include_str!("../../sample-logs/tasks/task-1.toml")).unwrap();
        let setup = Setup::new(&task, Arm::sample().unwrap()).unwrap();
        let search = Search { budget: Budget::Evaluations(2000), ..Search::default() };
        let front = crate::plan::search(&setup, &search, |_| ControlFlow::Continue(())).unwrap().front;
        let rest_s = setup.resting_s();
        let scale = |t_s: f64| (t_s * (t_s - rest_s).powi(5)).sqrt();
        let near = |ceilings: &Ceilings, around_s: f64| {
            let smoothest =
                |held: &Ceilings| choose(&setup, &front, held, (Rule::Best(Objective::RmsJerk), None)).ok();
            near(ceilings, around_s, smoothest, |plan| plan.timing.objectives[Objective::Duration])
        };
        let found = near(&Ceilings::NONE, 30.0);
        assert_eq!(found.len(), 7);
        let all: Vec<f64> = found
            .iter()
            .map(|(within_s, plan)| {
                let took_s = plan.timing.objectives[Objective::Duration];
                assert!(took_s <= *within_s && took_s > within_s - 1e-3, "{took_s} within {within_s}");
                plan.timing.objectives[Objective::RmsJerk] * scale(took_s)
            })
            .collect();
        let (least, most) = all.iter().fold((f64::MAX, 0.0_f64), |(a, b), v| (a.min(*v), b.max(*v)));
        assert!(most / least < 1.001, "{most} {least}");
        assert_eq!(near(&task.ceilings, 500.0).len(), 1, "the task ends at 40 s");
        let (within_s, plan) = &found[3];
        let less = bought(&setup, &plan.timing)[0];
        let due = 1.0 - scale(*within_s) / scale(within_s * (1.0 + MORE));
        assert!(less.0 == Objective::RmsJerk && (less.1 / due - 1.0).abs() < 0.02, "{less:?}, due {due}");
    }
}
