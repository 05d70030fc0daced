//! The paper's Table 3 beside ours.

use hydrotrace::{
    plan::{PlanError, PlanEvaluation, Rule, Setup, Timing, choose, ends},
    render::{
        kit::{Id, NONE, Section, Sentence, Table},
        plan::limit_cell,
    },
    task::{Ceilings, Objective},
    units::degrees_from_radians,
};

use crate::study::{PaperPlan, Study};

/// A plan of the paper: arrival at each key point, f2 printed in N, f3 printed in J.
struct Printed {
    name: &'static str,
    times_s: [f64; 7],
    f2: f64,
    f3: f64,
}

/// The paper's Table 3.
const TABLE_3: [Printed; 3] = [
    Printed { name: "A", times_s: [0.0, 2.01, 3.77, 5.79, 6.53, 8.85, 10.48], f2: 900.87, f3: 45.89 },
    Printed { name: "B", times_s: [0.0, 3.51, 7.34, 10.91, 13.31, 15.32, 18.94], f2: 362.25, f3: 10.95 },
    Printed { name: "C", times_s: [0.0, 1.51, 5.09, 10.23, 15.67, 18.98, 23.27], f2: 443.33, f3: 6.40 },
];

/// Compares the paper's plans with those of a front of the same task: each plan of the paper is followed
/// by ours, and the ends of our front come last.
///
/// # Errors
///
/// [`PlanError`] if the task is not the paper's.
pub(super) fn table_3(setup: &Setup, front: &[Timing]) -> Result<Vec<PaperPlan>, PlanError> {
    let evaluate = |times_s: &[f64]| PlanEvaluation::of(setup, times_s);
    let of = |timing: &Timing| evaluate(&setup.times_s(&timing.interval_s));
    let row = |plan: String, evaluation: Option<PlanEvaluation>| row(setup, plan, evaluation);
    let mut rows = Vec::new();
    for Printed { name, times_s, f2, f3 } in &TABLE_3 {
        let theirs = evaluate(times_s)?;
        let costs = theirs.objectives;
        let duration_s = costs[Objective::Duration];
        let paper = row(format!("paper's {name}"), Some(theirs));
        rows.push(PaperPlan { printed_f2: Some(*f2), printed_f3: Some(*f3), ..paper });
        if *name == "B" {
            let [Printed { times_s: of_a, f2, .. }, ..] = &TABLE_3;
            let ratio = duration_s / of_a[6];
            let stretched =
                row("paper's A as long as B".to_owned(), Some(evaluate(&of_a.map(|t_s| ratio * t_s))?));
            // With rest at both ends any mean of the jerk falls with the cube of the duration.
            rows.push(PaperPlan { printed_f2: Some(f2 / ratio.powi(3)), ..stretched });
        }
        let no_slower = Ceilings::NONE.with(Objective::Duration, duration_s);
        let no_worse = Ceilings::NONE.map_plan(|objective| costs[objective]);
        for (whose, bounds, rule) in [
            (format!("ours, no worse than {name} in f1, f2, f3"), no_worse, Rule::Ideal),
            (format!("ours, as fast as {name}: least f2"), no_slower, Rule::Best(Objective::RmsJerk)),
            (format!("ours, as fast as {name}: least f3"), no_slower, Rule::Best(Objective::RmsPower)),
        ] {
            let choice = choose(setup, front, &bounds, (rule, None)).ok();
            rows.push(row(whose, choice.map(|choice| of(&choice.timing)).transpose()?));
        }
    }
    for (Printed { name, .. }, end) in TABLE_3.iter().zip(ends(front).into_iter().flatten()) {
        let evaluation = front.get(end).map(of).transpose()?;
        rows.push(row(format!("ours, {name} of the front"), evaluation));
    }
    Ok(rows)
}

fn row(setup: &Setup, plan: String, evaluation: Option<PlanEvaluation>) -> PaperPlan {
    let Some(evaluation) = evaluation else { return PaperPlan { plan, ..PaperPlan::default() } };
    PaperPlan {
        plan,
        worst_limit: Some(limit_cell(&evaluation, &setup.joint_names())),
        limits_broken: Some(evaluation.broken().len()),
        duration_s: Some(evaluation.objectives[Objective::Duration]),
        rms_jerk_rad_s3: Some(evaluation.objectives[Objective::RmsJerk]),
        rms_power_w: Some(evaluation.objectives[Objective::RmsPower]),
        times_s: evaluation.times_s,
        ..PaperPlan::default()
    }
}

/// What the paper's Table 3 cannot be.
const FINDING: &str = "The paper prints f2 in N and f3 in J. No reading of its equations reproduces its f2 or f3 (29 \
     constructions of the spline and 54 functionals were tried). Nor can its table be an optimum of mean jerk: with rest \
     at both ends any mean of the jerk falls with the cube of the duration, and by the paper's own f2 of A its A stretched \
     to the duration of B has less than half of what it prints for B.";

/// Nothing if the paper's task was no subject.
pub(super) fn sections(study: &Study) -> Vec<Section> {
    if study.table_3.is_empty() {
        return Vec::new();
    }
    let cell = |value: Option<f64>, digits: usize| {
        value.map_or(NONE.to_owned(), |value| format!("{value:.digits$}"))
    };
    let rows = study.table_3.iter().map(|plan| {
        vec![
            plan.plan.clone(),
            plan.worst_limit.clone().unwrap_or_else(|| "no such plan".to_owned()),
            cell(plan.printed_f2, 2),
            cell(plan.printed_f3, 2),
            cell(plan.duration_s, 2),
            cell(plan.rms_jerk_rad_s3.map(degrees_from_radians), 4),
            cell(plan.rms_power_w, 2),
        ]
    });
    let numbers = ["printed f2 N", "printed f3 J", "f1 s", "f2 deg/s3", "f3 W"];
    let table = Table::new(&["plan", "worst limit"], &numbers, rows);
    let printed = "Printed: the paper's f2 and f3; the f2 of the stretched A follows from the paper's f2 of A. The rest \
                   is measured here, on an arm and limits that are not the paper's, which prints none.";
    let notes = [Sentence::note(FINDING), Sentence::note(printed)];
    vec![Section::new(Id::OTHER, "The paper's Table 3 (task simulation)", notes).with(table)]
}
