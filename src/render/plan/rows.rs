//! A plan in a row of a table, and its limits.

use crate::{
    plan::{Limit, Margin, PlanEvaluation},
    render::kit::{Column, NONE, Table},
    task::Objective,
};

/// A range used most this near to the arrival at a key point is used by the key point, s.
const AT_POINT_S: f64 = 1e-6;

/// Plans by name with arrivals, costs and the nearest limit.
pub(super) fn plans(rows: impl IntoIterator<Item = Vec<String>>) -> Table {
    let costs = Objective::OF_PLAN.iter().map(|objective| {
        let row = objective.row();
        Column::numbers(row.heading).meaning(row.explanation)
    });
    let words = ["plan", "arrivals s"].map(Column::words).into_iter();
    Table::of(words.chain(costs).chain([Column::numbers("nearest limit")]), rows)
}

pub(super) fn row(name: &str, evaluation: &PlanEvaluation, joints: &[String]) -> Vec<String> {
    let arrivals: Vec<String> = evaluation.times_s.iter().map(|t_s| format!("{t_s:.2}")).collect();
    let mut row = vec![name.to_owned(), arrivals.join(" ")];
    row.extend(Objective::OF_PLAN.iter().map(|&k| k.number(evaluation.objectives[k])));
    row.push(nearest(evaluation).first().map_or(NONE.to_owned(), |margin| {
        format!("{} % {}", percent(margin.share), subject(margin, joints))
    }));
    row
}

/// The limit that is broken most, and how many more are, or the nearest.
pub fn limit_cell(evaluation: &PlanEvaluation, joints: &[String]) -> String {
    let Some(worst) = nearest(evaluation).into_iter().next() else { return NONE.to_owned() };
    let worst = format!("{} % {}", percent(worst.share), subject(worst, joints));
    match evaluation.broken().len() {
        0 => worst,
        1 => format!("BREAKS {worst}"),
        more => format!("BREAKS {worst}, {} more", more - 1),
    }
}

/// A share in hundredths. Near a dead centre a force has no bound.
pub(super) fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    if percent > 999.9 { ">999.9".to_owned() } else { format!("{percent:.1}") }
}

/// Limits, the nearest first. A range that is used most at a key point says nothing of the plan.
pub(super) fn nearest(evaluation: &PlanEvaluation) -> Vec<&Margin> {
    let at_point =
        |margin: &Margin| evaluation.times_s.iter().any(|t_s| (t_s - margin.t_s).abs() < AT_POINT_S);
    let given = |margin: &Margin| margin.limit == Limit::Position && !margin.broken() && at_point(margin);
    let mut nearest: Vec<&Margin> = evaluation.margins.iter().filter(|margin| !given(margin)).collect();
    nearest.sort_by(|a, b| b.share.total_cmp(&a.share));
    nearest
}

/// `J3 speed`, `pump flow`.
pub(super) fn subject(margin: &Margin, joints: &[String]) -> String {
    match margin.joint.and_then(|joint| joints.get(joint)) {
        Some(joint) => format!("{joint} {}", margin.limit.name_of(margin.kind)),
        None => margin.limit.name().to_owned(),
    }
}
