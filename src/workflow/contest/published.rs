//! The paper's Table 3 beside what this arm makes of it.

use super::ContestFailure;
use crate::{
    plan::{PlanEvaluation, Rule, Setup, Timing, choose, ends},
    task::{Ceilings, Objective, Objectives},
};

/// What the paper prints of a plan: f2 as "N", f3 as "J".
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Printed {
    /// Of the impact.
    pub f2: f64,
    /// Of the energy; none for a plan that the paper does not have.
    pub f3: Option<f64>,
}

struct Plan {
    name: &'static str,
    times_s: [f64; 7],
    f2: f64,
    f3: f64,
}

/// The paper's Table 3.
const TABLE_3: [Plan; 3] = [
    Plan { name: "A", times_s: [0.0, 2.01, 3.77, 5.79, 6.53, 8.85, 10.48], f2: 900.87, f3: 45.89 },
    Plan { name: "B", times_s: [0.0, 3.51, 7.34, 10.91, 13.31, 15.32, 18.94], f2: 362.25, f3: 10.95 },
    Plan { name: "C", times_s: [0.0, 1.51, 5.09, 10.23, 15.67, 18.98, 23.27], f2: 443.33, f3: 6.40 },
];

/// Where a plan of the comparison comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Whose {
    /// The paper's, by its name.
    Paper(&'static str),
    /// The paper's A, every time multiplied to take as long as its B.
    Stretched,
    /// Ours: no slower than the paper's of this name, nor worse in f2 and f3; between those limits
    /// nearest to the best of all.
    Better(&'static str),
    /// Ours: no slower than the paper's of this name, and of least jerk.
    Smoothest(&'static str),
    /// Ours: no slower than the paper's of this name, and of least power.
    Thriftiest(&'static str),
    /// Ours: the end of the front in f1, f2 or f3 (A, B or C).
    End(&'static str),
}

/// One plan of the comparison.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// Whose it is.
    pub whose: Whose,
    /// What the paper prints; of the stretched plan f2 as it follows from A's, with the cube of time.
    pub printed: Option<Printed>,
    /// What it is worth here; `None` where no plan of ours is so.
    pub evaluation: Option<PlanEvaluation>,
}

/// The comparison.
#[derive(Debug, Clone, PartialEq)]
pub struct Table3 {
    /// Names of the joints, base first.
    pub joints: Vec<String>,
    /// The paper's plans, each followed by ours; then the ends of our front.
    pub rows: Vec<Row>,
}

/// Compares the paper's plans with those of a front of the same task.
pub(super) fn table_3(setup: &Setup, front: &[Timing]) -> Result<Table3, ContestFailure> {
    let mut rows = Vec::new();
    for plan in &TABLE_3 {
        let name = plan.name;
        let evaluation = PlanEvaluation::of(setup, &plan.times_s)?;
        let costs: Objectives = evaluation.objectives;
        let duration_s = costs[Objective::Duration];
        let printed = Printed { f2: plan.f2, f3: Some(plan.f3) };
        rows.push(Row { whose: Whose::Paper(name), printed: Some(printed), evaluation: Some(evaluation) });
        if name == "B" {
            rows.push(stretched(setup, duration_s)?);
        }
        let no_slower = Ceilings::NONE.with(Objective::Duration, duration_s);
        let no_worse = Ceilings::NONE.map_plan(|objective| costs[objective]);
        for (whose, bounds, rule) in [
            (Whose::Better(name), no_worse, Rule::Ideal),
            (Whose::Smoothest(name), no_slower, Rule::Best(Objective::RmsJerk)),
            (Whose::Thriftiest(name), no_slower, Rule::Best(Objective::RmsPower)),
        ] {
            let choice = choose(setup, front, &bounds, (rule, None)).ok();
            let evaluation = choice.map(|choice| of(setup, &choice.timing)).transpose()?;
            rows.push(Row { whose, printed: None, evaluation });
        }
    }
    for (plan, end) in TABLE_3.iter().zip(ends(front).into_iter().flatten()) {
        let evaluation = front.get(end).map(|timing| of(setup, timing)).transpose()?;
        rows.push(Row { whose: Whose::End(plan.name), printed: None, evaluation });
    }
    Ok(Table3 { joints: setup.joint_names(), rows })
}

fn of(setup: &Setup, timing: &Timing) -> Result<PlanEvaluation, ContestFailure> {
    Ok(PlanEvaluation::of(setup, &setup.times_s(&timing.interval_s))?)
}

fn stretched(setup: &Setup, duration_s: f64) -> Result<Row, ContestFailure> {
    let [Plan { times_s, f2, .. }, ..] = &TABLE_3;
    let ratio = duration_s / times_s[6];
    let evaluation = PlanEvaluation::of(setup, &times_s.map(|t_s| ratio * t_s))?;
    // Any mean of the jerk falls with the cube of time, rest at both ends given.
    let printed = Printed { f2: f2 / ratio.powi(3), f3: None };
    Ok(Row { whose: Whose::Stretched, printed: Some(printed), evaluation: Some(evaluation) })
}
