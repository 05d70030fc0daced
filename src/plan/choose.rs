//! Which plan of a front to run.

use serde::{Deserialize, Deserializer, Serialize, Serializer, de::Error};

use super::{
    Evaluator, Setup, Timing,
    descend::{COARSE, FINE, NEARLY, descend},
    exact,
    front::best_of,
    goal::{Goal, Merit},
};
use crate::task::{ByObjective, Ceilings, Objective, Objectives, Weights};

/// How to choose among the plans that keep to the ceilings and, where none is set on time, take at most [`HORIZON`] times
/// as long as the fastest of them. Objectives are scaled by their range over those plans: slower ones, down to a standstill,
/// would make any range what the longest interval makes it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Rule {
    /// The least weighted sum.
    Weights,
    /// Nearest to the point that has the best of every objective.
    Ideal,
    /// Where a convex front bulges most from the plane through its ends, each objective scaled by its range (Das 1999,
    /// doi:10.1007/BF01195985): equal weights, whatever the task weighs.
    Knee,
    /// The best of one objective.
    Best(Objective),
}

impl Rule {
    /// Every rule.
    pub fn all() -> impl Iterator<Item = Self> {
        let best = Objective::OF_PLAN.iter().map(|&objective| Self::Best(objective));
        [Self::Weights, Self::Ideal, Self::Knee].into_iter().chain(best)
    }

    /// Its name in options and documents.
    pub fn name(self) -> &'static str {
        match self {
            Self::Weights => "weights",
            Self::Ideal => "ideal",
            Self::Knee => "knee",
            Self::Best(objective) => objective.row().rule,
        }
    }

    /// The rule of a name.
    pub fn named(name: &str) -> Option<Self> {
        Self::all().find(|rule| rule.name() == name)
    }
}

impl Serialize for Rule {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

impl<'de> Deserialize<'de> for Rule {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let name = String::deserialize(deserializer)?;
        Self::named(&name).ok_or_else(|| D::Error::custom(format!("{name:?} is not a rule")))
    }
}

/// A plan and why it was chosen.
#[derive(Debug, Clone, PartialEq)]
pub struct Choice {
    /// The plan, after a last descent by the rule.
    pub timing: Timing,
    /// The rule.
    pub rule: Rule,
    /// Weights, where the rule is by weights.
    pub weights: Option<Weights>,
    /// Plans of the front that keep to the ceilings and the horizon; 0 if only the last descent reached them.
    pub within: usize,
    /// The longest time that was considered, s, where neither rule nor ceilings say one.
    pub horizon_s: Option<f64>,
    /// Plans of the front.
    pub of: usize,
    /// Evaluations of the last descent.
    pub evaluations: u64,
    /// What the rule lessens.
    pub(super) merit: Merit,
    /// What the last descent kept to.
    pub(super) ceilings: Ceilings,
}

impl Choice {
    /// By what share one plan is better than another by the rule, at the prices that it has at the chosen plan.
    pub fn gain(&self, from: &Objectives, to: &Objectives) -> f64 {
        let merit = self.merit.at_prices_of(&self.timing.objectives);
        let (before, after) = (merit.of(from), merit.of(to));
        if matches!(merit, Merit::Logarithms(_)) {
            1.0 - (after - before).exp()
        } else {
            1.0 - after / before
        }
    }
}

impl Choice {
    /// The least time, where no plan by times alone keeps all limits; `nearest`: that which breaks them least.
    pub fn without_front(nearest: Timing, ceilings: &Ceilings) -> Self {
        Self {
            timing: nearest,
            rule: Rule::Best(Objective::Duration),
            weights: None,
            within: 0,
            horizon_s: None,
            of: 0,
            evaluations: 0,
            merit: Merit::alone(Objective::Duration),
            ceilings: within_reach(ceilings),
        }
    }

    /// The same rule at a plan that is above ceilings, which another shape is to keep to.
    pub fn above(self, timing: Timing, ceilings: &Ceilings) -> Self {
        Self { timing, within: 0, horizon_s: None, ceilings: within_reach(ceilings), ..self }
    }
}

/// Why no plan can be chosen.
#[derive(Debug, Clone, PartialEq)]
pub enum NoChoice {
    /// The front has no plans.
    Empty,
    /// None keeps to the ceilings.
    Ceilings {
        /// The plan that comes nearest.
        nearest: Box<Timing>,
    },
}

/// Times the fastest plan's duration: there jerk has fallen to 2 % or less, and what more time buys is little.
pub const HORIZON: f64 = 2.0;
/// Evaluations of the last descent at most.
const LAST: u64 = 600;
/// Times that the fastest plan is quickened and descends from there.
const QUICKENED: usize = 3;
/// Distance that descents keep from ceilings, as a share of them.
const ROUNDING: f64 = 1e-6;

/// Index of the plan that is best in each objective of a plan (A, B and C of the paper's table 3); `None`
/// for an empty front.
pub fn ends(front: &[Timing]) -> Option<Vec<usize>> {
    Objective::OF_PLAN.iter().map(|&objective| best_of(front, objective)).collect()
}

/// Chooses from a front; the chosen plan then descends by its rule as far as it goes.
///
/// # Errors
///
/// [`NoChoice`] if the front is empty or no plan keeps to the ceilings, not even after a descent from
/// the nearest.
pub fn choose(
    setup: &Setup,
    front: &[Timing],
    ceilings: &Ceilings,
    (rule, weights): (Rule, Option<Weights>),
) -> Result<Choice, NoChoice> {
    let share = |timing: &Timing, k| timing.objectives[k] / ceilings[k];
    let excess = |timing: &Timing| Objective::OF_PLAN.iter().map(|&k| share(timing, k)).fold(1.0, f64::max);
    let mut evaluator = Evaluator::new(setup);
    let mut within: Vec<&Timing> = front.iter().filter(|timing| excess(timing) <= 1.0).collect();
    let (count, mut used) = (within.len(), 0);
    let reached = if within.is_empty() {
        let nearest = front.iter().min_by(|a, b| excess(a).total_cmp(&excess(b)));
        nearest.map(|nearest| {
            let goal = Goal {
                merit: Merit::even(),
                ceilings: within_reach(ceilings),
                evaluations: LAST,
                trust: NEARLY,
                enough: COARSE,
            };
            let end = descend(setup, &mut evaluator, &nearest.interval_s, &goal);
            used = end.evaluations;
            let (exact, more) =
                end.timing.map_or((None, 0), |timing| exact::kept(setup, &timing, goal.merit, goal.ceilings));
            used += more;
            let nearer = |timing: &Timing| timing.violation <= 0.0 && excess(timing) < excess(nearest);
            exact.filter(nearer).unwrap_or_else(|| nearest.clone())
        })
    } else {
        None
    };
    match &reached {
        Some(timing) if excess(timing) > 1.0 => {
            return Err(NoChoice::Ceilings { nearest: Box::new(timing.clone()) });
        }
        reached => within.extend(reached),
    }
    let mut own = within_reach(ceilings);
    let horizon_s = horizon_s(&within, ceilings, rule);
    if let Some(horizon_s) = horizon_s {
        within.retain(|timing| timing.objectives[Objective::Duration] <= horizon_s);
        own = own.with(Objective::Duration, horizon_s);
    }
    let count = count.min(within.len());
    let scale = Scale::of(&within);
    let weights = weights.filter(|_| rule == Rule::Weights);
    let merit = scale.merit(rule, weights);
    let picked = within.iter().copied().min_by(|a, b| worth(merit, a).total_cmp(&worth(merit, b)));
    let picked = picked.ok_or(NoChoice::Empty)?;
    let goal = Goal { merit, ceilings: own, evaluations: LAST, trust: NEARLY, enough: FINE };
    let end = descend(setup, &mut evaluator, &picked.interval_s, &goal);
    used += end.evaluations;
    let (exact, more) = end.timing.map_or((None, 0), |timing| exact::kept(setup, &timing, merit, own));
    used += more;
    let better = exact.filter(|timing| {
        timing.violation <= 0.0 && excess(timing) <= 1.0 && worth(merit, timing) < worth(merit, picked)
    });
    let mut timing = better.unwrap_or_else(|| picked.clone());
    if rule == Rule::Best(Objective::Duration) {
        // Where a descent stands at a kink, all times alike may still be shorter, and it goes on from there.
        for _ in 0..QUICKENED {
            let Some(quicker) = exact::quickest(setup, Some(&timing), |quicker| excess(quicker) <= 1.0)
            else {
                break;
            };
            let end = descend(setup, &mut evaluator, &quicker.interval_s, &goal);
            let (exact, more) =
                end.timing.map_or((None, 0), |timing| exact::kept(setup, &timing, merit, own));
            used += end.evaluations + more;
            let better = |timing: &Timing| {
                timing.violation <= 0.0
                    && excess(timing) <= 1.0
                    && worth(merit, timing) < worth(merit, &quicker)
            };
            timing = exact.filter(better).unwrap_or(quicker);
        }
    }
    Ok(Choice {
        timing,
        rule,
        weights,
        within: count,
        horizon_s,
        of: front.len(),
        evaluations: used,
        merit,
        ceilings: own,
    })
}

/// The longest time to consider, s; `None` where the rule compares nothing or a ceiling says it.
fn horizon_s(within: &[&Timing], ceilings: &Ceilings, rule: Rule) -> Option<f64> {
    let compares = !matches!(rule, Rule::Best(_)) && ceilings[Objective::Duration].is_infinite();
    let times_s = within.iter().map(|timing| timing.objectives[Objective::Duration]);
    compares
        .then(|| HORIZON * times_s.fold(f64::INFINITY, f64::min))
        .filter(|horizon_s| horizon_s.is_finite())
}

/// Ceilings as a descent takes them, which ends at one to within rounding, on either side of it.
fn within_reach(ceilings: &Ceilings) -> Ceilings {
    ceilings.map_plan(|k| ceilings[k] * (1.0 - ROUNDING))
}

fn worth(merit: Merit, timing: &Timing) -> f64 {
    merit.of(&timing.objectives)
}

/// Least and range of each objective.
struct Scale {
    ideal: Objectives,
    range: ByObjective,
}

impl Scale {
    fn of(plans: &[&Timing]) -> Self {
        let (mut ideal, mut worst) = (Objectives::NONE, Objectives::ZERO);
        for timing in plans {
            for &k in Objective::OF_PLAN {
                ideal[k] = ideal[k].min(timing.objectives[k]);
                worst[k] = worst[k].max(timing.objectives[k]);
            }
        }
        // What is zero in all plans, as the power of an arm without masses, tells none from another.
        let range = |k| if worst[k] > 0.0 { (worst[k] - ideal[k]).max(1e-9 * worst[k]) } else { 1.0 };
        Self { ideal, range: ideal.map_plan(range) }
    }

    fn merit(&self, rule: Rule, weights: Option<Weights>) -> Merit {
        match rule {
            // Where a convex front bulges most from the plane through its ends, scaled, its sum is least.
            Rule::Weights | Rule::Knee => {
                let given = weights.unwrap_or(Weights::ZERO.map_plan(|_| 1.0));
                let sum: f64 = given.plan().iter().sum();
                Merit::Sum(given.map_plan(|k| given[k] / sum / self.range[k]))
            }
            Rule::Ideal => Merit::Distance { ideal: self.ideal, scale: self.range },
            Rule::Best(objective) => Merit::alone(objective),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use super::{super::Search, *};
    use crate::{arm::Arm, moea::Budget, task::Task};

    #[test]
    fn the_longest_interval_of_a_task_does_not_decide_what_is_chosen() {
        let chosen = |longest_s: f64| {
            let text = include_str!("../../sample-logs/tasks/simulation.toml");
            let text =
                text.replace("interval_s = [0.3, 20.0]", &format!("interval_s = [0.3, {longest_s:?}]"));
            let setup = Setup::new(&Task::parse(&text).unwrap(), Arm::sample().unwrap()).unwrap();
            let search = Search { budget: Budget::Evaluations(3000), ..Search::default() };
            let front = super::super::search(&setup, &search, |_| ControlFlow::Continue(())).unwrap().front;
            let [ideal, sum] = [Rule::Ideal, Rule::Weights]
                .map(|rule| choose(&setup, &front, &Ceilings::NONE, (rule, None)).unwrap());
            assert!(ideal.within < front.len() && ideal.horizon_s == sum.horizon_s);
            [ideal, sum].map(|choice| choice.timing.objectives[Objective::Duration])
        };
        let (short, long) = (chosen(10.0), chosen(120.0));
        for (short_s, long_s) in short.into_iter().zip(long) {
            assert!((long_s / short_s - 1.0).abs() < 0.05, "{short_s} s and {long_s} s");
        }
    }

    /// Where neither limits nor the longest intervals bind, the best shape is one and only its time changes: with rests of
    /// d the mean of squared jerk falls with T (T - d)^5.
    #[test]
    fn the_smoothest_plan_under_a_ceiling_on_time_is_that_of_the_closed_form() {
        let tasks = [
            (include_str!("../../sample-logs/tasks/task-1.toml"), [20.0_f64, 55.0]),
            (include_str!("../../sample-logs/tasks/task-2.toml"), [22.0, 60.0]),
        ];
        for (text, [from_s, to_s]) in tasks {
            let setup = Setup::new(&Task::parse(text).unwrap(), Arm::sample().unwrap()).unwrap();
            let search = Search { budget: Budget::Evaluations(2000), ..Search::default() };
            let front = super::super::search(&setup, &search, |_| ControlFlow::Continue(())).unwrap().front;
            let rest_s = setup.resting_s();
            let scaled: Vec<f64> = (0..20)
                .map(|i| {
                    let within_s = from_s * (to_s / from_s).powf(f64::from(i) / 19.0);
                    let ceilings = Ceilings::NONE.with(Objective::Duration, within_s);
                    let rule = Rule::Best(Objective::RmsJerk);
                    let found = choose(&setup, &front, &ceilings, (rule, None)).unwrap().timing.objectives;
                    assert!(found[Objective::Duration] <= within_s);
                    found[Objective::RmsJerk] * (within_s * (within_s - rest_s).powi(5)).sqrt()
                })
                .collect();
            let least = scaled.iter().copied().fold(f64::INFINITY, f64::min);
            let worst = scaled.iter().fold(0.0, |most: f64, value| most.max(value / least - 1.0));
            assert!(worst < 1e-3, "{:.2} % above the optimum", 100.0 * worst);
        }
    }
}
