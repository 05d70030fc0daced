//! Plans as tables.

use super::{name, shown};
use crate::{
    plan::{BEYOND, Limit, Margin, Objectives, PlanEvaluation, Rule},
    render::{NONE, Part, Sheet, tables::remark_parts},
    task::Bounds,
    units::degrees_from_radians,
    workflow::plan::{Options, Planned},
};

/// A limit or an interval used more than this binds.
const TIGHT: f64 = 0.999;
/// Margins listed.
const NEAREST: usize = 6;
/// A range used most this near to the arrival at a key point is used by the key point, s.
const AT_POINT_S: f64 = 1e-6;

/// What was planned, for people.
pub fn plan_parts(
    title: &str,
    algorithm: &str,
    options: &Options,
    bounds: &Bounds,
    planned: &Planned,
) -> Vec<Part> {
    let start = if options.search.seeded { "descents" } else { "random plans" };
    let mut parts = vec![
        Part::Title(title.to_owned()),
        Part::Line(format!(
            "{} plans of which none is better than another in everything, from {} evaluations: {algorithm}, started \
             from {start}, seed {}. Hypervolume {:.4} of the box from the best of each objective to {BEYOND} times the \
             range.",
            planned.front.len(),
            planned.evaluations,
            options.search.seed,
            planned.hypervolume,
        )),
        Part::Heading("Plans".into()),
    ];
    let [a, b, c] = &planned.best;
    let named = [("A  fastest", a), ("B  smoothest", b), ("C  least power", c), ("chosen", &planned.chosen)];
    parts.push(Part::Sheet(Sheet {
        head: vec!["plan", "arrivals s", "time s", "RMS jerk deg/s3", "RMS power W", "nearest limit"],
        left: 2,
        rows: named.map(|(name, evaluation)| row(name, evaluation, &planned.joints)).to_vec(),
    }));
    if planned.fastest_converged == Some(false) {
        parts.push(Part::Line(
            "The fastest plan was still getting faster when its share of the evaluations was used up: give more with \
             --evaluations."
                .into(),
        ));
    }
    parts.push(Part::Heading("The chosen plan".into()));
    parts.push(Part::Line(reason(bounds, planned)));
    parts.push(Part::Line(
        "Another: --choose fastest, smoothest, thriftiest, knee or ideal, --weights, or ceilings in the task.".into(),
    ));
    parts.extend(margin_parts(&planned.chosen, &planned.joints));
    parts.push(Part::Line(kept(&planned.chosen)));
    remark_parts(&planned.remarks, &mut parts);
    parts
}

/// One given plan, for people.
pub fn judged_parts(title: &str, joints: &[String], evaluation: &PlanEvaluation) -> Vec<Part> {
    let mut parts = vec![
        Part::Title(title.to_owned()),
        Part::Sheet(Sheet {
            head: vec!["plan", "arrivals s", "time s", "RMS jerk deg/s3", "RMS power W", "nearest limit"],
            left: 2,
            rows: vec![row("given", evaluation, joints)],
        }),
        Part::Line(format!("The joints do and take up {:.0} J of work together.", evaluation.energy_j)),
    ];
    parts.extend(margin_parts(evaluation, joints));
    parts.push(Part::Line(kept(evaluation)));
    parts
}

fn kept(evaluation: &PlanEvaluation) -> String {
    match evaluation.broken().len() {
        0 => "All limits are kept.".to_owned(),
        broken => format!("{broken} of {} limits are broken.", evaluation.margins.len()),
    }
}

fn row(name: &str, evaluation: &PlanEvaluation, joints: &[String]) -> Vec<String> {
    let Objectives { duration_s, rms_jerk_rad_s3, rms_power_w } = evaluation.objectives;
    let arrivals: Vec<String> = evaluation.times_s.iter().map(|t_s| format!("{t_s:.2}")).collect();
    let nearest = nearest(evaluation).into_iter().next();
    vec![
        name.to_owned(),
        arrivals.join(" "),
        format!("{duration_s:.2}"),
        format!("{:.4}", degrees_from_radians(rms_jerk_rad_s3)),
        format!("{rms_power_w:.2}"),
        nearest.map_or(NONE.to_owned(), |margin| {
            format!("{} % {}", percent(margin.share), subject(margin, joints))
        }),
    ]
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
fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    if percent > 999.9 { ">999.9".to_owned() } else { format!("{percent:.1}") }
}

/// Limits, the nearest first. A range that is used most at a key point says nothing of the plan.
fn nearest(evaluation: &PlanEvaluation) -> Vec<&Margin> {
    let at_point =
        |margin: &Margin| evaluation.times_s.iter().any(|t_s| (t_s - margin.t_s).abs() < AT_POINT_S);
    let given = |margin: &Margin| margin.limit == Limit::Position && !margin.broken() && at_point(margin);
    let mut nearest: Vec<&Margin> = evaluation.margins.iter().filter(|margin| !given(margin)).collect();
    nearest.sort_by(|a, b| b.share.total_cmp(&a.share));
    nearest
}

/// `J3 speed`, `pump flow`.
fn subject(margin: &Margin, joints: &[String]) -> String {
    match margin.joint.and_then(|joint| joints.get(joint)) {
        Some(joint) => format!("{joint} {}", name(margin.limit)),
        None => name(margin.limit).to_owned(),
    }
}

/// Why a plan was chosen.
fn reason(bounds: &Bounds, planned: &Planned) -> String {
    let choice = &planned.choice;
    let why = match choice.rule {
        Rule::Weights => {
            let weights = choice.weights.map_or(String::new(), |w| {
                format!(" {} time, {} jerk, {} power", w.duration, w.rms_jerk, w.rms_power)
            });
            format!("Least sum by the weights{weights}, each objective scaled by its range")
        }
        Rule::Ideal => "Nearest to the best of every objective, each scaled by its range".into(),
        Rule::Knee => "The knee: giving up a little of one objective costs most of another".into(),
        Rule::Fastest => "The fastest".into(),
        Rule::Smoothest => "The smoothest".into(),
        Rule::Thriftiest => "The one of least power".into(),
    };
    let ceilings = ceilings(bounds);
    let among = if ceilings.is_empty() {
        format!("all {}", choice.of)
    } else {
        format!("{} of {} within {}", choice.within, choice.of, ceilings.join(", "))
    };
    format!("{why}, among {among}; then moved to where the rule has its optimum.")
}

fn ceilings(bounds: &Bounds) -> Vec<String> {
    let each = [
        bounds.duration_s.map(|s| format!("{s} s")),
        bounds.rms_jerk_rad_s3.map(|rad| format!("{:.6} deg/s3", degrees_from_radians(rad))),
        bounds.rms_power_w.map(|w| format!("{w} W")),
    ];
    each.into_iter().flatten().map(|text| trimmed(&text)).collect()
}

/// Without the zeros that a fixed number of decimals leaves.
fn trimmed(text: &str) -> String {
    match text.split_once(' ') {
        Some((number, unit)) if number.contains('.') => {
            format!("{} {unit}", number.trim_end_matches('0').trim_end_matches('.'))
        }
        _ => text.to_owned(),
    }
}

/// What of each limit is used, and the nearest with their places.
fn margin_parts(evaluation: &PlanEvaluation, joints: &[String]) -> Vec<Part> {
    let share = |limit: Limit, joint: Option<usize>| {
        let found = evaluation.margins.iter().find(|margin| margin.limit == limit && margin.joint == joint);
        found.map_or(NONE.to_owned(), |margin| percent(margin.share))
    };
    let together = |limit: Limit| match share(limit, None) {
        none if none == NONE => format!("no limit on {}", super::name(limit)),
        percent => format!("{} {percent} %", super::name(limit)),
    };
    let rows = joints.iter().enumerate().map(|(j, joint)| {
        let of = |values: &[f64]| values.get(j).copied().unwrap_or(f64::NAN);
        let mut row = vec![
            joint.clone(),
            format!("{:.4}", degrees_from_radians(of(&evaluation.rms_jerk_rad_s3))),
            format!("{:.2}", of(&evaluation.rms_power_w)),
        ];
        row.extend(Limit::OF_JOINT.map(|limit| share(limit, Some(j))));
        row
    });
    let nearest: Vec<&Margin> =
        nearest(evaluation).into_iter().take(NEAREST.max(evaluation.broken().len())).collect();
    let listed_position = nearest.iter().any(|margin| margin.limit == Limit::Position);
    let listed = nearest.into_iter().map(|margin| {
        vec![
            subject(margin, joints),
            shown(margin.limit, margin.value),
            allowed(margin),
            percent(margin.share),
            format!("{:.2}", margin.t_s),
        ]
    });
    let mut parts = vec![
        Part::Heading("Jerk, power, and use of each limit in %".into()),
        Part::Sheet(Sheet {
            head: vec![
                "joint",
                "RMS jerk deg/s3",
                "RMS power W",
                "range",
                "speed",
                "acceleration",
                "jerk",
                "torque",
                "rod speed",
                "rod force",
            ],
            left: 1,
            rows: rows.collect(),
        }),
        Part::Line(format!("All together: {}, {}.", together(Limit::PumpFlow), together(Limit::ToolSpeed))),
        Part::Heading("Nearest limits".into()),
        Part::Sheet(Sheet {
            head: vec!["limit", "value", "allowed", "used %", "at s"],
            left: 1,
            rows: listed.collect(),
        }),
    ];
    if listed_position {
        parts.push(Part::Line(
            "Of a position, used is the way from the middle of its range to the end.".into(),
        ));
    }
    parts
}

/// What is allowed; of a range the end that is nearer, and on which side of it.
fn allowed(margin: &Margin) -> String {
    let most = shown(margin.limit, margin.allowed);
    let kept = margin.broken() != (margin.value <= margin.allowed);
    match (margin.limit, kept) {
        (Limit::Position, true) => format!("<= {most}"),
        (Limit::Position, false) => format!(">= {most}"),
        _ => most,
    }
}

/// What the nearest timing of an infeasible task breaks, a line each, the worst first.
pub fn broken_lines(joints: &[String], longest_s: f64, nearest: &PlanEvaluation) -> Vec<String> {
    let lines = nearest.broken().into_iter().map(|margin| {
        format!(
            "{} is {} at {:.2} s, {} is allowed: {} % too much",
            subject(margin, joints),
            shown(margin.limit, margin.value),
            margin.t_s,
            shown(margin.limit, margin.allowed),
            percent(margin.share - 1.0)
        )
    });
    let mut lines: Vec<String> = lines.collect();
    let longest = nearest.interval_s.iter().filter(|s| **s > longest_s * TIGHT).count();
    if longest > 0 {
        let all = nearest.interval_s.len();
        lines.push(format!(
            "{longest} of {all} intervals are the longest allowed, {longest_s} s (interval_s)"
        ));
    }
    lines
}

/// What the nearest plan exceeds its ceilings by, a line each, and what holds it there.
pub fn ceiling_lines(
    bounds: &Bounds,
    joints: &[String],
    nearest: &PlanEvaluation,
    share: [f64; 3],
) -> Vec<String> {
    let f = nearest.objectives;
    let values = [
        (format!("time {:.2} s", f.duration_s), bounds.duration_s.map(|s| format!("{s:.2} s"))),
        (
            format!("RMS jerk {:.4} deg/s3", degrees_from_radians(f.rms_jerk_rad_s3)),
            bounds.rms_jerk_rad_s3.map(|rad| format!("{:.4} deg/s3", degrees_from_radians(rad))),
        ),
        (format!("RMS power {:.2} W", f.rms_power_w), bounds.rms_power_w.map(|w| format!("{w:.2} W"))),
    ];
    let mut lines: Vec<String> = values
        .into_iter()
        .zip(share)
        .filter(|(_, share)| *share > 1.0)
        .filter_map(|((value, ceiling), share)| {
            Some(format!("{value}, {} is asked for: {:.1} % too much", ceiling?, 100.0 * (share - 1.0)))
        })
        .collect();
    let mut tight: Vec<&Margin> = nearest.margins.iter().filter(|margin| margin.share > TIGHT).collect();
    tight.sort_by(|a, b| b.share.total_cmp(&a.share));
    let tight: Vec<String> =
        tight.iter().map(|margin| format!("{} at {:.2} s", subject(margin, joints), margin.t_s)).collect();
    if !tight.is_empty() {
        lines.push(format!("limits that bind it: {}", tight.join(", ")));
    }
    lines
}
