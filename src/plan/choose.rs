//! Which plan of a front to run.

use serde::Serialize;

use super::{
    Evaluator, Setup, Timing,
    descend::{COARSE, FINE, Goal, Merit, NEARLY, descend},
    exact,
    front::best_of,
};
use crate::{
    moea::das_dennis,
    task::{Bounds, Weights},
};

/// How to choose among the plans that keep to the ceilings. Objectives are scaled by their range over
/// those plans.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Rule {
    /// The least weighted sum.
    Weights,
    /// Nearest to the point that has the best of every objective.
    Ideal,
    /// Where giving up a little of one objective costs most of another: the largest expected loss
    /// under all weights if the plan were not there (Branke, Deb, Dierolf and Osswald 2004,
    /// doi:10.1007/978-3-540-30217-9_73).
    Knee,
    /// The least time.
    Fastest,
    /// The least jerk.
    Smoothest,
    /// The least power.
    Thriftiest,
}

/// A plan and why it was chosen.
#[derive(Debug, Clone, PartialEq)]
pub struct Choice {
    /// The plan, after a last descent by the rule.
    pub timing: Timing,
    /// The rule.
    pub rule: Rule,
    /// Weights of f1, f2 and f3, where the rule is by weights.
    pub weights: Option<Weights>,
    /// Plans of the front that keep to the ceilings; 0 if only the last descent reached them.
    pub within: usize,
    /// Plans of the front.
    pub of: usize,
    /// Evaluations of the last descent.
    pub evaluations: u64,
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
        /// Its objectives by their ceilings, f1, f2, f3; 0 where there is none.
        share: [f64; 3],
    },
}

/// Evaluations of the last descent at most.
const LAST: u64 = 600;
/// Divisions of the weights that knees are judged by.
const WEIGHTS: usize = 12;

/// Ceilings in the order f1, f2, f3; infinite where there are none.
fn ceilings(bounds: &Bounds) -> [f64; 3] {
    [bounds.duration_s, bounds.rms_jerk_rad_s3, bounds.rms_power_w]
        .map(|bound| bound.unwrap_or(f64::INFINITY))
}

/// Indices of the plans that are best in f1, f2 and f3 (A, B and C of the paper's table 3); `None`
/// for an empty front.
pub fn ends(front: &[Timing]) -> Option<[usize; 3]> {
    Some([best_of(front, 0)?, best_of(front, 1)?, best_of(front, 2)?])
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
    bounds: &Bounds,
    (rule, weights): (Rule, Option<Weights>),
) -> Result<Choice, NoChoice> {
    let ceilings = ceilings(bounds);
    let share = |timing: &Timing| {
        let f = timing.objectives.as_array();
        [f[0] / ceilings[0], f[1] / ceilings[1], f[2] / ceilings[2]]
    };
    let excess = |timing: &Timing| share(timing).into_iter().fold(1.0, f64::max);
    let mut evaluator = Evaluator::new(setup);
    let mut within: Vec<&Timing> = front.iter().filter(|timing| excess(timing) <= 1.0).collect();
    let (count, mut used) = (within.len(), 0);
    let reached = if within.is_empty() {
        let nearest = front.iter().min_by(|a, b| excess(a).total_cmp(&excess(b)));
        nearest.map(|nearest| {
            let goal = Goal {
                merit: Merit::Logarithms([1.0 / 3.0; 3]),
                ceilings: ceilings.map(|ceiling| ceiling * (1.0 - 1e-6)),
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
            return Err(NoChoice::Ceilings { nearest: Box::new(timing.clone()), share: share(timing) });
        }
        reached => within.extend(reached),
    }
    let scale = Scale::of(&within);
    let weights = weights.filter(|_| rule == Rule::Weights);
    let merit = scale.merit(rule, weights);
    let picked = match rule {
        Rule::Knee => knee(&within, &scale),
        _ => within.iter().copied().min_by(|a, b| worth(merit, a).total_cmp(&worth(merit, b))),
    };
    let picked = picked.ok_or(NoChoice::Empty)?;
    // A knee is a knee of this front; from it one may only descend to what is better in everything.
    let own = if rule == Rule::Knee { picked.objectives.as_array() } else { ceilings };
    let goal = Goal { merit, ceilings: own, evaluations: LAST, trust: NEARLY, enough: FINE };
    let end = descend(setup, &mut evaluator, &picked.interval_s, &goal);
    used += end.evaluations;
    let (exact, more) = end.timing.map_or((None, 0), |timing| exact::kept(setup, &timing, merit, own));
    used += more;
    let better = exact.filter(|timing| {
        timing.violation <= 0.0 && excess(timing) <= 1.0 && worth(merit, timing) < worth(merit, picked)
    });
    let timing = better.unwrap_or_else(|| picked.clone());
    Ok(Choice { timing, rule, weights, within: count, of: front.len(), evaluations: used })
}

fn worth(merit: Merit, timing: &Timing) -> f64 {
    merit.of(timing.objectives.as_array())
}

/// Least and range of each objective.
struct Scale {
    ideal: [f64; 3],
    range: [f64; 3],
}

impl Scale {
    fn of(plans: &[&Timing]) -> Self {
        let mut ideal = [f64::INFINITY; 3];
        let mut worst = [0.0_f64; 3];
        for timing in plans {
            for (k, f) in timing.objectives.as_array().into_iter().enumerate() {
                ideal[k] = ideal[k].min(f);
                worst[k] = worst[k].max(f);
            }
        }
        let mut range = [1.0; 3];
        for k in 0..3 {
            range[k] = (worst[k] - ideal[k]).max(1e-9 * worst[k]).max(f64::MIN_POSITIVE);
        }
        Self { ideal, range }
    }

    fn merit(&self, rule: Rule, weights: Option<Weights>) -> Merit {
        match rule {
            Rule::Weights => {
                let given = weights.map_or([1.0; 3], |w| [w.duration, w.rms_jerk, w.rms_power]);
                let sum: f64 = given.iter().sum();
                let mut scaled = [0.0; 3];
                for k in 0..3 {
                    scaled[k] = given[k] / sum / self.range[k];
                }
                Merit::Sum(scaled)
            }
            Rule::Ideal => Merit::Distance { ideal: self.ideal, scale: self.range },
            Rule::Knee => Merit::Logarithms([1.0 / 3.0; 3]),
            Rule::Fastest => Merit::Logarithms([1.0, 0.0, 0.0]),
            Rule::Smoothest => Merit::Logarithms([0.0, 1.0, 0.0]),
            Rule::Thriftiest => Merit::Logarithms([0.0, 0.0, 1.0]),
        }
    }

    fn scaled(&self, timing: &Timing) -> [f64; 3] {
        let f = timing.objectives.as_array();
        std::array::from_fn(|k| (f[k] - self.ideal[k]) / self.range[k])
    }
}

/// The plan whose absence would cost most, summed over weights for which it is the best.
fn knee<'a>(plans: &[&'a Timing], scale: &Scale) -> Option<&'a Timing> {
    let scaled: Vec<[f64; 3]> = plans.iter().map(|timing| scale.scaled(timing)).collect();
    let mut loss = vec![0.0; plans.len()];
    for weights in das_dennis(3, WEIGHTS).unwrap_or_default().chunks_exact(3) {
        let sum = |i: usize| -> f64 { scaled[i].iter().zip(weights).map(|(f, w)| f * w).sum() };
        let mut order: Vec<usize> = (0..plans.len()).collect();
        order.sort_by(|&a, &b| sum(a).total_cmp(&sum(b)));
        if let [best, second, ..] = order[..] {
            loss[best] += sum(second) - sum(best);
        }
    }
    let most = (0..plans.len()).max_by(|&a, &b| loss[a].total_cmp(&loss[b]).then(b.cmp(&a)))?;
    Some(plans[most])
}
