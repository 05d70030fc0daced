//! Plans as tables.

use std::fmt::Write;

use super::{
    broken::TIGHT,
    degrees::degrees,
    rows::{nearest, percent, plans, row, subject},
    shown,
};
use crate::{
    plan::{BEYOND, HORIZON, Limit, Margin, NoShape, PlanEvaluation, Rule},
    render::kit::{Document, Id, NONE, Section, Sentence, Table, counted},
    series::JointKind,
    task::{Ceilings, Objective, Weights},
    units::degrees_from_radians,
    workflow::plan::{Options, Planned, Shaped},
};

/// Margins listed.
const NEAREST: usize = 6;

/// What was planned, for people.
pub(crate) fn document(
    title: &str,
    algorithm: &str,
    options: &Options,
    ceilings: &Ceilings,
    planned: &Planned,
) -> Document {
    let start = if options.search.seeded { "descents" } else { "random plans" };
    let mut searched = format!(
        "{} on the Pareto front, from {} evaluations: {algorithm}, started from {start}, seed {}.",
        counted(planned.front.len(), "plan"),
        planned.evaluations,
        options.search.seed,
    );
    if !planned.front.is_empty() {
        let _ = write!(
            searched,
            " Hypervolume {:.4} of the box from the best of each objective to {BEYOND} times the range.",
            planned.hypervolume
        );
    }
    let best = Objective::OF_PLAN.iter().zip(&planned.best);
    let mut rows: Vec<Vec<String>> = best
        .map(|(k, evaluation)| row(&format!("{}  {}", k.letter(), k.row().best), evaluation, &planned.joints))
        .collect();
    let by_times = planned.shaped.as_ref().and_then(|shaped| shaped.timing.as_ref());
    rows.extend(by_times.map(|timing| row("by times alone", timing, &planned.joints)));
    rows.push(row("chosen", &planned.chosen, &planned.joints));
    let growing =
        "The fastest plan was still becoming faster when the search ended: allow more --evaluations.";
    let longer = (planned.fastest_converged == Some(false)).then(|| Sentence::advice(growing));
    let rules: Vec<&str> = Rule::all().filter(|rule| *rule != Rule::Weights).map(Rule::name).collect();
    let curve = if planned.shaped.is_none() && planned.no_shape.is_none() {
        " With --shape free the curve between the key points is sought, too: it is faster, or smoother."
    } else {
        ""
    };
    let another = format!(
        "To choose another plan: --choose {}; --weights; or ceilings in the task.{curve}",
        rules.join(", ")
    );
    let mut document = Document::titled(title)
        .with(Section::plain(Id::SUMMARY, [Sentence::finding(searched)]))
        .with(Section::new(Id::OTHER, "Plans", [plans(rows)]).with_all(longer))
        .with(Section::new(
            Id::OTHER,
            "The chosen plan",
            [Sentence::finding(reason(ceilings, planned))]
                .into_iter()
                .chain(exchange(planned).map(Sentence::finding))
                .chain(shape(planned).map(Sentence::finding))
                .chain(shortest(planned).map(Sentence::finding))
                .chain((!planned.front.is_empty()).then(|| Sentence::advice(another))),
        ));
    document.sections.extend(near(options.near_s, planned));
    document.sections.extend(degrees(options.degrees, planned));
    document.sections.extend(margins(&planned.chosen, &planned.joints));
    document.remarked(&planned.remarks)
}

/// One given plan, for people.
///
/// `above`: ceilings of the task that it is above, by what share.
pub(crate) fn judged_document(
    title: &str,
    joints: &[String],
    evaluation: &PlanEvaluation,
    above: &[(Objective, f64)],
) -> Document {
    let work =
        format!("All joints together turn over {:.0} J of work, driving and braking.", evaluation.energy_j);
    let given = Section::plain(Id::SUMMARY, [plans([row("given", evaluation, joints)])]);
    let above = above.iter().map(|(objective, share)| {
        let ceiling = objective.row().ceiling;
        Sentence::finding(format!(
            "It is {:.1} % above {ceiling}, to which a search would keep.",
            100.0 * share
        ))
    });
    let mut document = Document::titled(title).with(given.with(Sentence::finding(work)).with_all(above));
    document.sections.extend(margins(evaluation, joints));
    document
}

fn kept(evaluation: &PlanEvaluation) -> String {
    match evaluation.broken().len() {
        0 => "All limits are kept.".to_owned(),
        broken => format!("{broken} of {} limits are broken.", evaluation.margins.len()),
    }
}

/// Intervals that the task allows no shorter.
fn shortest(planned: &Planned) -> Option<String> {
    let Planned { chosen, interval_s: [shortest_s, _], .. } = planned;
    let held = chosen.interval_s.iter().filter(|s| **s * TIGHT < *shortest_s).count();
    (held > 0).then(|| {
        format!(
            "{held} of {} intervals have the shortest duration allowed, {shortest_s} s (interval_s): a faster plan needs less.",
            chosen.interval_s.len()
        )
    })
}

/// What a free shape gained, where one was sought.
fn shape(planned: &Planned) -> Option<String> {
    let Some(Shaped { timing, pieces }) = &planned.shaped else {
        let why = planned.no_shape.map(|why| match why {
            NoShape::TooManyIntervals { found, most } => {
                format!(
                    "{found} intervals are more than the {most} that a free shape takes in so many pieces."
                )
            }
            NoShape::Broken(margin) => {
                let what = subject(&margin, &planned.joints);
                format!("the free shape breaks {what}, which slowing down does not mend.")
            }
            NoShape::NoGain => "a free shape gains nothing by this rule.".to_owned(),
        });
        return why.map(|why| format!("Its shape is that of its times: {why}"));
    };
    let Some(timing) = timing else {
        return Some(format!(
            "Its shape is free, {pieces} pieces an interval: by times alone no plan keeps all limits."
        ));
    };
    let change = |k: &Objective| {
        let (was, is) = (timing.objectives[*k], planned.chosen.objectives[*k]);
        // An arm without masses takes no power.
        // Rounded first: less than nothing by nothing is -0.0.
        let percent = (1000.0 * (is / was - 1.0)).round() / 10.0 + 0.0;
        (was > 0.0).then(|| format!("{} {percent:+.1} %", k.row().short))
    };
    let changes: Vec<String> = Objective::OF_PLAN.iter().filter_map(change).collect();
    Some(format!(
        "Its shape is free, {pieces} pieces an interval; against the best times alone: {}.",
        changes.join(", ")
    ))
}

/// Why a plan was chosen.
fn reason(ceilings: &Ceilings, planned: &Planned) -> String {
    let choice = &planned.choice;
    let why = match choice.rule {
        Rule::Weights => {
            let each = |w: Weights| {
                let each = Objective::OF_PLAN.iter().map(|&k| format!("{} {}", w[k], k.row().short));
                format!(" {}", each.collect::<Vec<_>>().join(", "))
            };
            let weights = choice.weights.map_or(String::new(), each);
            format!("Smallest weighted sum{weights}; each objective is scaled by its range")
        }
        Rule::Ideal => "Nearest to the best values of all objectives, each scaled by its range".into(),
        Rule::Knee => {
            "The knee of the front, where it bulges most: smallest sum of the objectives, each scaled by its range".into()
        }
        Rule::Best(objective) => format!("The plan of least {}", objective.row().name),
    };
    let text = |(k, ceiling): (Objective, f64)| trimmed(&format!("{:.6} {}", k.shown(ceiling), k.row().unit));
    let ceilings: Vec<String> = ceilings.known().map(text).collect();
    let among = if let Some(horizon_s) = choice.horizon_s {
        let mut kept = vec![format!("{HORIZON} times the time of the fastest, {horizon_s:.2} s")];
        kept.extend(ceilings);
        format!("{} of {} within {}", choice.within, choice.of, kept.join(", "))
    } else if ceilings.is_empty() {
        "the whole front".to_owned()
    } else {
        format!("{} of {} within {}", choice.within, choice.of, ceilings.join(", "))
    };
    if choice.of == 0 {
        return format!("{why}: there is no front to choose another from.");
    }
    format!("{why}, chosen from {among}, then refined by this rule.")
}

/// What a little more time would buy, where the task has more.
fn exchange(planned: &Planned) -> Option<String> {
    let Planned { chosen, interval_s: [_, longest_s], .. } = planned;
    if chosen.interval_s.iter().all(|s| *s > longest_s * TIGHT) {
        return Some(format!(
            "All intervals have the longest duration allowed, {longest_s} s (interval_s): no plan of this task takes more time."
        ));
    }
    let less =
        |(k, share): &(Objective, f64)| format!("{:.1} % less {}", 100.0 * share.max(0.0), k.row().name);
    let less: Vec<String> = planned.bought.iter().map(less).collect();
    (!less.is_empty()).then(|| format!("1 % more time would buy {}.", less.join(" or ")))
}

/// The front where it was asked for.
fn near(near_s: Option<f64>, planned: &Planned) -> Option<Section> {
    let near_s = near_s?;
    let of_front = planned.best.first().map_or(f64::NAN, |plan| plan.objectives[Objective::Duration]);
    let fastest_s = of_front.min(planned.chosen.objectives[Objective::Duration]);
    let title = format!("The smoothest plans near {near_s} s");
    let one = |(within_s, plan): &(f64, PlanEvaluation)| {
        row(&format!("within {within_s} s"), plan, &planned.joints)
    };
    Some(if planned.near.is_empty() {
        let none = format!(
            "No plan that keeps all limits and ceilings was found that is so fast: the fastest takes {fastest_s:.2} s."
        );
        Section::new(Id::OTHER, title, [Sentence::finding(none)])
    } else {
        let advice = "Each was sought by itself, as far as descents go; --json has its exact arrivals.";
        Section::new(Id::OTHER, title, [plans(planned.near.iter().map(one))]).with(Sentence::advice(advice))
    })
}

/// What the objective of all joints takes a length for.
const COUNTED_AS: &str = "In the RMS jerk of all joints 1 m counts as 1 rad: 1 mm/s3 as 0.0573 deg/s3.";

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
fn margins(evaluation: &PlanEvaluation, joints: &[String]) -> [Section; 2] {
    let share = |limit: Limit, joint: Option<usize>| {
        let found = evaluation.margins.iter().find(|margin| margin.limit == limit && margin.joint == joint);
        found.map_or(NONE.to_owned(), |margin| percent(margin.share))
    };
    let together = |limit: Limit| match share(limit, None) {
        none if none == NONE => format!("no limit on {}", limit.name()),
        percent => format!("{} {percent} %", limit.name()),
    };
    let slides = evaluation.joint_kinds.contains(&JointKind::Slides);
    let rows = joints.iter().enumerate().map(|(j, joint)| {
        let of = |values: &[f64]| values.get(j).copied().unwrap_or(f64::NAN);
        let jerk = of(&evaluation.rms_jerk_rad_s3);
        let slides_here = evaluation.joint_kinds.get(j) == Some(&JointKind::Slides);
        let jerk = match (slides, slides_here) {
            (false, _) => format!("{:.4}", degrees_from_radians(jerk)),
            (true, false) => format!("{:.4} deg/s3", degrees_from_radians(jerk)),
            (true, true) => format!("{:.3} mm/s3", 1e3 * jerk),
        };
        let mut row = vec![joint.clone(), jerk, format!("{:.2}", of(&evaluation.rms_power_w))];
        row.extend(Limit::OF_JOINT.map(|limit| share(limit, Some(j))));
        row
    });
    let nearest: Vec<&Margin> =
        nearest(evaluation).into_iter().take(NEAREST.max(evaluation.broken().len())).collect();
    let listed_position = nearest.iter().any(|margin| margin.limit == Limit::Position);
    let listed = nearest.into_iter().map(|margin| {
        let value = shown(margin.limit, margin.kind, margin.value);
        vec![
            subject(margin, joints),
            value,
            allowed(margin),
            percent(margin.share),
            format!("{:.2}", margin.t_s),
        ]
    });
    let jerk = if slides { "RMS jerk" } else { "RMS jerk deg/s3" };
    let effort = if slides { "torque, force" } else { "torque" };
    let numbers =
        [jerk, "RMS power W", "range", "speed", "acceleration", "jerk", effort, "rod speed", "rod force"];
    let all = format!("All together: {}, {}.", together(Limit::PumpFlow), together(Limit::ToolSpeed));
    let together = slides.then(|| Sentence::note(COUNTED_AS));
    let position = listed_position
        .then(|| Sentence::note("For a position, 0 % is the middle of its range and 100 % its end."));
    [
        Section::new(
            Id::OTHER,
            "Jerk, power, and percent of each limit used",
            [Table::new(&["joint"], &numbers, rows)],
        )
        .with(Sentence::finding(all))
        .with_all(together),
        Section::new(
            Id::OTHER,
            "Nearest limits",
            [Table::new(&["limit"], &["value", "allowed", "% of limit", "at s"], listed)],
        )
        .with_all(position)
        .with(Sentence::finding(kept(evaluation))),
    ]
}

/// The limits that a plan comes nearest to, a line each.
pub(super) fn nearest_lines(evaluation: &PlanEvaluation, joints: &[String]) -> Vec<String> {
    let line = |margin: &&Margin| {
        let value = shown(margin.limit, margin.kind, margin.value);
        format!(
            "{} {value} at {:.2} s, limit {}: {} % used",
            subject(margin, joints),
            margin.t_s,
            allowed(margin),
            percent(margin.share),
        )
    };
    nearest(evaluation).iter().take(3).map(line).collect()
}

/// What is allowed; of a range the end that is nearer, and on which side of it.
fn allowed(margin: &Margin) -> String {
    let most = shown(margin.limit, margin.kind, margin.allowed);
    // At the end itself the side is a matter of rounding.
    if shown(margin.limit, margin.kind, margin.value) == most {
        return most;
    }
    let kept = margin.broken() != (margin.value <= margin.allowed);
    match (margin.limit, kept) {
        (Limit::Position, true) => format!("<= {most}"),
        (Limit::Position, false) => format!(">= {most}"),
        _ => most,
    }
}
