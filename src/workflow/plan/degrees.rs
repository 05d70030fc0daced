//! The same task by splines of the other degrees.

use std::ops::ControlFlow;

use super::{Options, PlanRequest, shaped::Made};
use crate::{
    plan::{Choice, PlanEvaluation, Setup, choose, search},
    task::Task,
};

/// Degrees of splines that pass the key points without steps in jerk.
const DEGREES: [u8; 3] = [5, 6, 7];
/// A gain by the rule that is worth naming.
const WORTH_NAMING: f64 = 0.01;

/// A plan by a spline of another degree, chosen by the same rule.
#[derive(Debug, Clone, PartialEq)]
pub struct OfDegree {
    /// Degree of the spline.
    pub degree: u8,
    /// By what share it is better than the task's own by the rule; negative if it is worse.
    pub better: f64,
    /// The plan.
    pub chosen: PlanEvaluation,
}

impl OfDegree {
    /// Whether it is better by so much that the task may want it.
    pub fn is_better(&self) -> bool {
        self.better > WORTH_NAMING
    }
}

/// By every other degree that has a plan, searched and chosen as the task's own, which is `here`.
pub(super) fn degrees(
    request: &PlanRequest,
    options: &Options,
    (own, here): (&Choice, &PlanEvaluation),
) -> Vec<OfDegree> {
    let others = DEGREES.into_iter().filter(|degree| *degree != request.task.degree);
    let one = |degree| {
        let task = Task { degree, ..request.task.clone() };
        let setup = Setup::new(&task, request.setup.arm().clone()).ok()?;
        let found = search(&setup, &options.search, |_| ControlFlow::Continue(())).ok()?;
        let choice = choose(&setup, &found.front, &task.ceilings, (own.rule, own.weights)).ok()?;
        let chosen = Made::of(&setup, &task, &choice, options.shape).ok()?.plan;
        Some(OfDegree { degree, better: own.gain(&here.objectives, &chosen.objectives), chosen })
    };
    others.filter_map(one).collect()
}
