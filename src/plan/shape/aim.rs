//! What a descent of the shape lessens, and within what.

use crate::{
    plan::{Choice, Rule, goal::Merit},
    task::{Ceilings, Objective, Objectives, Weights},
};

/// Weight of jerk in every merit, against a sum of one: it settles joints that bound nothing.
const SETTLE: f64 = 1e-3;

/// Room below ceilings for what a plan is slowed down by at last.
const SLOWED: f64 = 1e-3;

/// Distance from the ceilings of a choice, as a share: a descent ends at one to within rounding, on either side of it.
const ROUNDED: f64 = 1e-5;

/// What decides the duration of a curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Pace {
    /// The limits: every segment is as fast as they allow.
    Fastest,
    /// It is given, s, dwells included.
    Within(f64),
    /// It is sought with the shape.
    Sought,
}

/// A merit to lessen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Aim {
    merit: Merit,
    /// Makes the weights of the logarithms sum to one where the descent starts.
    scale: f64,
    /// What the objectives must not exceed.
    pub(super) ceilings: Ceilings,
    pub(super) pace: Pace,
    /// Loads are taken to be so many times what they are at the instants looked at, for the peaks between them.
    pub(super) guard: f64,
}

impl Aim {
    /// Of a choice. One objective alone keeps what the choice found it by: the fastest plan its pace, the smoothest its
    /// time, the one of least power its jerk. Any other rule keeps its prices, also where it weighs distances.
    pub(super) fn of(choice: &Choice) -> Self {
        let chosen = &choice.timing.objectives;
        let merit = choice.merit.at_prices_of(chosen);
        let free = |k: Objective| choice.ceilings[k].is_infinite();
        let pace = match choice.rule {
            Rule::Best(Objective::Duration) if free(Objective::RmsJerk) && free(Objective::RmsPower) => {
                Pace::Fastest
            }
            Rule::Best(Objective::RmsJerk) if free(Objective::RmsPower) => {
                Pace::Within(chosen[Objective::Duration])
            }
            _ => Pace::Sought,
        };
        let clear = choice.ceilings.map_plan(|k| choice.ceilings[k] * (1.0 - ROUNDED));
        let mut ceilings = if pace == Pace::Sought { clear } else { Ceilings::NONE };
        // Of a plan above a ceiling the jerk says nothing: a faster one has more.
        let above = |k: &Objective| chosen[*k] > choice.ceilings[*k] * (1.0 + SLOWED);
        if choice.rule == Rule::Best(Objective::RmsPower) && !Objective::OF_PLAN.iter().any(above) {
            // The least power has jerk that nothing but its limits holds.
            let jerk = ceilings[Objective::RmsJerk].min(chosen[Objective::RmsJerk]);
            ceilings = ceilings.with(Objective::RmsJerk, jerk);
        }
        let prices = merit.slopes(chosen);
        let sum: f64 = prices.plan().iter().sum();
        Self { merit, scale: 1.0 / sum.max(f64::MIN_POSITIVE), ceilings, pace, guard: 1.0 }
    }

    /// The least jerk within ceilings, whether or not the start keeps them.
    pub(super) fn smoother(ceilings: &Ceilings) -> Self {
        let ceilings = ceilings.map_plan(|k| ceilings[k] * (1.0 - SLOWED));
        let merit = Merit::alone(Objective::RmsJerk);
        Self { merit, scale: 1.0, ceilings, pace: Pace::Sought, guard: 1.0 }
    }

    /// The least time, whatever the other objectives.
    pub(super) fn fastest() -> Self {
        let merit = Merit::alone(Objective::Duration);
        Self { merit, scale: 1.0, ceilings: Ceilings::NONE, pace: Pace::Fastest, guard: 1.0 }
    }

    /// The least time within ceilings, whether or not the start keeps them.
    pub(super) fn faster(ceilings: &Ceilings) -> Self {
        if [Objective::RmsJerk, Objective::RmsPower].iter().all(|k| ceilings[*k].is_infinite()) {
            return Self::fastest();
        }
        let ceilings = ceilings.map_plan(|k| ceilings[k] * (1.0 - SLOWED));
        Self { ceilings, pace: Pace::Sought, ..Self::fastest() }
    }

    /// Of a plan; the less the better.
    pub(super) fn merit(&self, objectives: &Objectives) -> f64 {
        self.scale * self.merit.of(objectives) + SETTLE * objectives[Objective::RmsJerk].ln()
    }

    /// Slopes of the merit by the logarithms of the objectives.
    pub(super) fn slopes(&self, objectives: &Objectives) -> Weights {
        let own = self.merit.slopes(objectives);
        let own = own.map_plan(|k| self.scale * own[k]);
        own.with(Objective::RmsJerk, own[Objective::RmsJerk] + SETTLE)
    }

    /// Whether power counts.
    pub(super) fn counts_power(&self, objectives: &Objectives) -> bool {
        self.slopes(objectives)[Objective::RmsPower] > 0.0 || self.ceilings[Objective::RmsPower].is_finite()
    }

    /// Logarithms of objectives as shares of their ceilings, where there are any.
    pub(super) fn beyond(&self, objectives: &Objectives) -> impl Iterator<Item = (Objective, f64)> {
        let shares = objectives.map_plan(|k| (objectives[k] / self.ceilings[k]).ln());
        Objective::OF_PLAN.iter().map(move |&k| (k, shares[k])).filter(|(_, beyond)| beyond.is_finite())
    }
}
