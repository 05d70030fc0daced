//! What the plan breaks that comes nearest to a task that has none, a line each.

use super::{
    rows::{limit_cell, percent, subject},
    shown,
};
use crate::{
    plan::{Limit, Margin, PlanEvaluation},
    task::{Boundary, Ceilings, Objective, Task},
};

/// A limit or an interval used more than this binds.
pub(super) const TIGHT: f64 = 0.999;

/// What the nearest timing of an infeasible task breaks, a line each, the worst first. `enough_s`: the longest interval of a plan
/// that keeps all limits, where longer intervals than the task allows make one.
pub(crate) fn broken_lines(
    (task, joints): (&Task, &[String]),
    enough_s: Option<f64>,
    nearest: &PlanEvaluation,
) -> Vec<String> {
    let lines = nearest.broken().into_iter().map(|margin| {
        format!(
            "{} is {} at {:.2} s, {} is allowed: {} % beyond it",
            subject(margin, joints),
            shown(margin.limit, margin.kind, margin.value),
            margin.t_s,
            shown(margin.limit, margin.kind, margin.allowed),
            percent(margin.share - 1.0)
        )
    });
    let mut lines: Vec<String> = lines.collect();
    let enough = enough_s.map(|s| format!("with intervals up to {:.0} s all limits are kept", s.ceil()));
    match (longest(task.interval_s[1], nearest), &enough) {
        (Some(longest), Some(enough)) => lines.push(format!("{longest}: {enough}")),
        (longest, enough) => lines.extend(longest.or(enough.clone())),
    }
    if enough.is_none() {
        lines.extend(nearest.broken().first().and_then(|margin| mended(task, joints, margin, nearest)));
    }
    if lines.is_empty() {
        lines.push(format!(
            "every limit holds but for rounding; {} is the nearest",
            limit_cell(nearest, joints)
        ));
    }
    lines
}

/// What mends a limit that no times do.
fn mended(task: &Task, joints: &[String], margin: &Margin, nearest: &PlanEvaluation) -> Option<String> {
    let after = nearest.times_s.partition_point(|arrival_s| *arrival_s <= margin.t_s);
    let [before, after] = [after.max(1), (after + 1).min(nearest.times_s.len())];
    let ends = [(1, before, &task.start), (nearest.times_s.len(), after, &task.end)];
    let speed = |end: &Boundary| {
        let name = joints.get(margin.joint?)?;
        let own = task.joints.iter().position(|joint| joint == name)?;
        Some((name, *end.velocity_rad_s.get(own)?)).filter(|(_, speed)| speed.abs() > 0.0)
    };
    let mut moves = ends.into_iter().filter(|(end, point, _)| end == point);
    let moves = moves.find_map(|(_, point, end)| Some((point, speed(end)?)));
    match (margin.limit, moves) {
        (Limit::Position, Some((point, (name, speed)))) => Some(format!(
            "{name} moves at key point {point} at {}/s, and to stop from that speed, or to come to it, takes more room than its range \
             leaves there: less speed, more range, or more acceleration and jerk give it",
            margin.kind.says(speed)
        )),
        (Limit::Position, None) => Some(format!(
            "the curve swings there between key points {before} and {after}: with dwell_s = 0.1 at both the arm stops at them, and \
             stays between them on its way"
        )),
        (Limit::Torque | Limit::RodForce, _) => Some(format!(
            "that is {}{after}, and no more time mends what the weight takes at rest: less payload, another posture or a wider limit \
             does",
            if before < after {
                format!("between key points {before} and ")
            } else {
                "at key point ".to_owned()
            }
        )),
        _ => None,
    }
}

/// Intervals that the task allows no longer.
fn longest(longest_s: f64, nearest: &PlanEvaluation) -> Option<String> {
    let longest = nearest.interval_s.iter().filter(|s| **s > longest_s * TIGHT).count();
    let all = nearest.interval_s.len();
    (longest > 0).then(|| {
        format!("{longest} of {all} intervals have the longest duration allowed, {longest_s} s (interval_s)")
    })
}

/// What the nearest plan exceeds its ceilings by, a line each, and what holds it there.
pub(crate) fn ceiling_lines(
    ceilings: &Ceilings,
    joints: &[String],
    (longest_s, nearest): (f64, &PlanEvaluation),
) -> Vec<String> {
    let mut lines = over_ceilings(ceilings, nearest);
    lines.extend(longest(longest_s, nearest));
    let mut tight: Vec<&Margin> = nearest.margins.iter().filter(|margin| margin.share > TIGHT).collect();
    tight.sort_by(|a, b| b.share.total_cmp(&a.share));
    let tight: Vec<String> =
        tight.iter().map(|margin| format!("{} at {:.2} s", subject(margin, joints), margin.t_s)).collect();
    if !tight.is_empty() {
        lines.push(format!("limits that hold it there: {}", tight.join(", ")));
    }
    lines
}

/// What a plan exceeds ceilings by, a line each.
pub(super) fn over_ceilings(ceilings: &Ceilings, nearest: &PlanEvaluation) -> Vec<String> {
    let over = |(k, ceiling): (Objective, f64)| {
        let share = nearest.objectives[k] / ceiling;
        let (name, found, asked) = (k.row().name, k.text(nearest.objectives[k]), k.text(ceiling));
        (share > 1.0)
            .then(|| format!("{name} {found}, the ceiling is {asked}: {} % above it", percent(share - 1.0)))
    };
    ceilings.known().filter_map(over).collect()
}
