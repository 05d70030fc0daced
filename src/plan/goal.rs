//! What a descent lessens, and within what.

use crate::task::{ByObjective, Ceilings, Objective, Objectives, Weights};

/// What a descent lessens.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Merit {
    /// Sum of the objectives' logarithms by weights that sum to one.
    Logarithms(Weights),
    /// Sum of the objectives by weights.
    Sum(Weights),
    /// Distance to a point, each objective divided by a scale.
    Distance { ideal: Objectives, scale: ByObjective },
}

impl Merit {
    /// One objective alone.
    pub(super) const fn alone(objective: Objective) -> Self {
        Self::Logarithms(Weights::ZERO.with(objective, 1.0))
    }

    /// All objectives alike.
    pub(super) fn even() -> Self {
        Self::Logarithms(Weights::ZERO.map_plan(|_| 1.0 / Objective::OF_PLAN.len() as f64))
    }

    pub(super) fn of(&self, objectives: &Objectives) -> f64 {
        let sum = |term: &dyn Fn(Objective) -> f64| Objective::OF_PLAN.iter().map(|&k| term(k)).sum::<f64>();
        match self {
            // An arm without masses has no power: a constant.
            Self::Logarithms(weights) => sum(&|k| weights[k] * objectives[k].max(f64::MIN_POSITIVE).ln()),
            Self::Sum(weights) => sum(&|k| weights[k] * objectives[k]),
            Self::Distance { ideal, scale } => {
                sum(&|k| ((objectives[k] - ideal[k]) / scale[k]).powi(2)).sqrt()
            }
        }
    }
}

impl Merit {
    /// Slopes by the logarithms of the objectives.
    pub(super) fn slopes(&self, objectives: &Objectives) -> Weights {
        match self {
            Self::Logarithms(weights) => *weights,
            Self::Sum(weights) => weights.map_plan(|k| weights[k] * objectives[k]),
            Self::Distance { ideal, scale } => {
                let distance = self.of(objectives).max(f64::MIN_POSITIVE);
                let slope = |k| (objectives[k] - ideal[k]) / scale[k].powi(2) / distance * objectives[k];
                Weights::ZERO.map_plan(slope)
            }
        }
    }

    /// The same, but for a distance the weighted sum that exchanges objectives at the rates that it has here: a plan
    /// may be better than the point that the distance is to.
    pub(super) fn at_prices_of(&self, objectives: &Objectives) -> Self {
        match self {
            Self::Distance { .. } => {
                let slopes = self.slopes(objectives);
                let prices = slopes.map_plan(|k| (slopes[k] / objectives[k]).max(0.0));
                if prices.are_weights() { Self::Sum(prices) } else { Self::even() }
            }
            other => *other,
        }
    }
}

/// What a descent is to do.
#[derive(Debug, Clone, Copy)]
pub(super) struct Goal {
    pub(super) merit: Merit,
    /// What the objectives must not exceed.
    pub(super) ceilings: Ceilings,
    /// Evaluations at most, unless the start alone takes more.
    pub(super) evaluations: u64,
    /// Longest first step, in logarithms of the intervals.
    pub(super) trust: f64,
    /// The descent has settled when a step gains less than this.
    pub(super) enough: f64,
}
