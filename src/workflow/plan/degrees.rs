//! The same task by splines of the other degrees.

use std::ops::ControlFlow;

use super::{Options, PlanRequest, shaped::chosen};
use crate::{
    plan::{Choice, PlanEvaluation, Setup, search},
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
    /// The plan, and by what share it is better than the task's own by the rule, negative if it is worse; `None` where no
    /// plan of that degree was found.
    pub chosen: Option<(PlanEvaluation, f64)>,
}

impl OfDegree {
    /// By what share it is better, if that is so much that the task may want it.
    pub fn better(&self) -> Option<f64> {
        self.chosen.as_ref().map(|(_, better)| *better).filter(|better| *better > WORTH_NAMING)
    }
}

/// By every other degree, searched and chosen as the task's own, which is `here`.
pub(super) fn degrees(
    request: &PlanRequest,
    options: &Options,
    (own, here): (&Choice, &PlanEvaluation),
) -> Vec<OfDegree> {
    let others = DEGREES.into_iter().filter(|degree| *degree != request.task.degree);
    let plan = |degree| {
        let task = Task { degree, ..request.task.clone() };
        let setup = Setup::new(&task, request.setup.arm().clone()).ok()?;
        let found = search(&setup, &options.search, |_| ControlFlow::Continue(())).ok()?;
        let rule = (own.rule, own.weights);
        let (_, made) = chosen(&setup, &task, options.shape, (&found.front, rule)).ok()?;
        let better = own.gain(&here.objectives, &made.plan.objectives);
        Some((made.plan, better))
    };
    others.map(|degree| OfDegree { degree, chosen: plan(degree) }).collect()
}
