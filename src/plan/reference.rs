//! The box that hypervolumes of fronts are measured in.

use crate::{
    moea::indicator::hypervolume,
    task::{ByObjective, Objective},
};

/// How far beyond the range of a front the hypervolume's reference point lies.
pub const BEYOND: f64 = 1.1;

/// From the best of each objective of a plan to [`BEYOND`] times the range of a front.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reference {
    ideal: ByObjective,
    range: ByObjective,
}

impl Reference {
    /// Of a front, objectives by plan, each in the order of the table.
    pub fn of<'a>(front: impl Iterator<Item = &'a [f64]>) -> Self {
        let (mut ideal, mut worst) = (ByObjective::NONE, ByObjective::NONE.map_plan(|_| f64::NEG_INFINITY));
        for f in front {
            for (&k, f) in Objective::OF_PLAN.iter().zip(f) {
                ideal[k] = ideal[k].min(*f);
                worst[k] = worst[k].max(*f);
            }
        }
        Self { ideal, range: ideal.map_plan(|k| (worst[k] - ideal[k]).max(f64::MIN_POSITIVE)) }
    }

    /// The corner of the best.
    pub fn ideal(&self) -> ByObjective {
        self.ideal
    }

    /// The corner that hypervolumes are measured from.
    pub fn reference_point(&self) -> ByObjective {
        self.ideal.map_plan(|k| self.ideal[k] + BEYOND * self.range[k])
    }

    /// Share of the box that a front dominates.
    pub fn measure<'a>(&self, front: impl Iterator<Item = &'a [f64]>) -> f64 {
        let scaled = |(&k, f): (&Objective, &f64)| (f - self.ideal[k]) / self.range[k] / BEYOND;
        let scaled: Vec<f64> = front.flat_map(|f| Objective::OF_PLAN.iter().zip(f).map(scaled)).collect();
        hypervolume(&scaled, &vec![1.0; Objective::OF_PLAN.len()])
    }
}
