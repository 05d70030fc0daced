//! The answers of a fleet in sentences and tables.

use super::{day, name, shown, shown_change, shown_rate, shown_unit};
use crate::{
    render::{
        kit::{Document, Id, NONE, Section, Sentence, Table, counted, percent, probability},
        metric::weighed,
    },
    replay::Rules,
    workflow::fleet::{
        Alike, Change, Drift, Effect, GateResult, Gated, JointEffect, JointTrend, LevelStep, Worst,
        WorstJoint,
    },
};

fn interval_a_day(unit: &str, [low, high]: [f64; 2]) -> String {
    format!("{} to {}", shown_rate(unit, low), shown_rate(unit, high))
}

fn interval(unit: &str, [low, high]: [f64; 2]) -> String {
    format!("{} to {}", shown_change(unit, low), shown_change(unit, high))
}

/// The joints of a fleet, the worst first; `most`: rows that are shown.
pub(crate) fn worst(worst: &Worst, most: usize) -> Document {
    let of = format!("{} of {}", counted(worst.runs, "run"), counted(worst.machines, "machine"));
    let of = format!("{of}: the {} by joint, the worst first.", name(worst.by));
    let rows = worst.joints.iter().take(most).map(|joint| {
        let value = |value: f64| shown(&joint.unit, value);
        vec![
            joint.machine.clone(),
            joint.joint.clone(),
            shown_unit(&joint.unit).to_owned(),
            value(joint.median),
            value(joint.p95),
            value(joint.largest),
            joint.above_fleet.map_or(NONE.to_owned(), percent),
            joint.runs.to_string(),
            joint.at.as_deref().map_or(NONE, day).to_owned(),
        ]
    });
    let numbers = ["median", "95 % below", "largest", "against fleet %", "runs", "largest on"];
    let table = Table::new(&["machine", "joint", "unit"], &numbers, rows);
    let section = Section::plain(Id::SUMMARY, [Sentence::finding(of)]).with(table);
    let section = section.with_all(more(worst.joints.len(), most));
    let kinds = worst.joints.iter().filter_map(WorstJoint::kind);
    let section = section.with_all(weighed(&Rules::default(), kinds));
    let note =
        "Against fleet: by how much starts are worse than the same starts of the same plan on all machines.";
    Document::default().with(section.with(Sentence::note(note))).remarked(&worst.remarks)
}

fn more(all: usize, most: usize) -> Option<Sentence> {
    (all > most).then(|| Sentence::note(format!("{} more; --all shows them.", all - most)))
}

pub(super) fn step_of(trend: &JointTrend) -> Option<&LevelStep> {
    trend.step.as_ref().filter(|_| trend.is_step)
}

/// Between which days a step is, and what it changes.
pub(super) fn stepped(trend: &JointTrend, step: &LevelStep) -> String {
    let unit = shown_unit(&trend.unit);
    let days = [&step.after, &step.by].map(|at| at.as_deref().map_or(NONE, day));
    let within = step.within_95.as_ref().map(|[from, to]| [day(from), day(to)]);
    let within = within.filter(|[from, to]| *from < days[0] || *to > days[1]);
    let within = within.map_or(String::new(), |[from, to]| format!(", surely between {from} and {to}"));
    format!(
        "{} {unit} from {} to {}{within} ({} {unit}, 95 %)",
        shown_change(&trend.unit, step.change),
        days[0],
        days[1],
        interval(&trend.unit, step.interval_95),
    )
}

/// What the level did before the last of its changes, in order; empty where there is but one.
fn before(trend: &JointTrend) -> String {
    let unit = shown_unit(&trend.unit);
    let Some((_, earlier)) = trend.changes.split_last().filter(|(_, earlier)| !earlier.is_empty()) else {
        return String::new();
    };
    let one = |change: &Change| {
        let days = [&change.after, &change.by].map(|at| at.as_deref().map_or(NONE, day));
        let by = shown_change(&trend.unit, change.change);
        let how = match change.per_day {
            Some((slope, _)) => format!(" evenly, {} {unit} a day", shown_rate(&trend.unit, slope)),
            None => String::new(),
        };
        format!("{by} {unit} from {} to {}{how}", days[0], days[1])
    };
    format!(" Before that: {}.", earlier.iter().map(one).collect::<Vec<_>>().join("; "))
}

pub(in crate::render) fn said(trend: &JointTrend) -> String {
    said_last(trend) + &before(trend)
}

fn said_last(trend: &JointTrend) -> String {
    if let Some(step) = step_of(trend) {
        return format!(
            "{} {}: the {} changes at once{}, by {}; q = {}.",
            trend.machine,
            trend.joint_and_direction(),
            name(trend.metric),
            if step.is_sure() { "" } else { ", or within days" },
            stepped(trend, step),
            probability(step.q_value),
        );
    }
    let grows = if trend.slope_per_day > 0.0 { "grows" } else { "falls" };
    let unit = shown_unit(&trend.unit);
    let since = trend.since.as_deref().map_or(String::new(), |since| format!(", since {}", day(since)));
    let since = if trend.changes_throughout() { ", over all runs".to_owned() } else { since };
    format!(
        "{} {}: the {} {grows} by {} {unit} a day ({} {unit}, 95 %){since}; q = {}.",
        trend.machine,
        trend.joint_and_direction(),
        name(trend.metric),
        shown_rate(&trend.unit, trend.slope_per_day.abs()).trim_start_matches('+'),
        interval_a_day(&trend.unit, trend.interval_95),
        probability(trend.q_value),
    )
}

/// The trends of a fleet; `most`: rows that are shown.
pub(crate) fn drift(drift: &Drift, most: usize) -> Document {
    let found: Vec<&JointTrend> = drift.trends.iter().filter(|trend| trend.found).collect();
    let of = format!("{} of {}", counted(drift.runs, "run"), counted(drift.machines, "machine"));
    let judged = drift.judged();
    let first = match (found.len(), drift.trends.len()) {
        (_, 0) => format!(
            "{of}: no joint has five runs of one plan, begun at different times, which a trend takes."
        ),
        (0, all) if judged == 0 => format!("{of}: nothing could be judged of {}.", counted(all, "trend")),
        (0, _) => format!("{of}: no drift and no step found among {}.", counted(judged, "trend")),
        (some, all) => format!("{of}: {some} of {} found.", counted(all, "trend")),
    };
    // What is found is never left out.
    let most = most.max(found.len());
    let mut section = Section::plain(Id::SUMMARY, [Sentence::finding(first)]);
    section = section.with_all(found.iter().map(|trend| Sentence::finding(said(trend))));
    section = section.with_all(drift.alike.iter().map(|one| Sentence::finding(alike(one))));
    if !drift.trends.is_empty() {
        section = section.with(trends(drift.trends.iter().take(most)));
    }
    section = section.with_all(more(drift.trends.len(), most));
    let note = "Each start is compared with the same start of the same plan. Runs of one day share oil and load: their mean \
                counts as one run, where a machine ran on five days or more. q: share of false discoveries if this trend \
                and all surer ones count as found; found: q below 5 %, and three robust deviations from what is \
                usual where ten joints or more tell that. A step is a level that changes between two runs and stays; it \
                stands in place of a trend where it explains the levels better. Where a level changed more than once, a day's change \
                is that of its last stretch. What four machines or more did alike at the same time is taken off.";
    section = section.with(Sentence::note(note));
    if found.iter().any(|trend| !trend.less_common) {
        section = section.with(Sentence::note(
            "What weather, oil and work do to all joints is not taken off everywhere, for fewer than four other machines tell it: where all \
             joints of a machine change alike, that may be why.",
        ));
    }
    section = section.with_all(not_judged(drift.too_few + drift.trends.len() - judged, drift.fewest_runs));
    Document::default().with(section).remarked(&drift.remarks)
}

/// So many machines that are alike in not doing what the others did are named.
const MOST_OTHERS: usize = 5;

/// What most machines did, which no trend of one of them tells.
fn alike(one: &Alike) -> String {
    let [after, by] = [&one.after, &one.by].map(|at| at.as_deref().map_or(NONE, day));
    let others = match one.others.as_slice() {
        others if (1..=MOST_OTHERS).contains(&others.len()) => format!(" (not {})", others.join(", ")),
        _ => String::new(),
    };
    format!(
        "{} of {} machines alike{others}: the {} {} by {:.0} % of what is usual from {after} to {by}, with the season, the oil and the work, or by what was \
         done to all of them. It is taken off the trends.",
        one.shared_by,
        one.of,
        name(one.metric),
        if one.change > 0.0 { "grows" } else { "falls" },
        100.0 * one.change.abs(),
    )
}

fn not_judged(too_few: usize, fewest: usize) -> Option<Sentence> {
    let (trends, runs) = (counted(too_few, "trend"), counted(fewest, "run"));
    let why = "not judged: fewer prove nothing among so many joints";
    (too_few > 0).then(|| Sentence::note(format!("{trends} with fewer than {runs} of one plan, {why}.")))
}

pub(super) fn q(trend: &JointTrend) -> f64 {
    step_of(trend).map_or(trend.q_value, |step| step.q_value)
}

fn trends<'a>(trends: impl Iterator<Item = &'a JointTrend>) -> Table {
    let rows = trends.map(|trend| {
        vec![
            trend.machine.clone(),
            trend.joint_and_direction(),
            name(trend.metric).to_owned(),
            shown_unit(&trend.unit).to_owned(),
            shown_rate(&trend.unit, trend.slope_per_day),
            interval_a_day(&trend.unit, trend.interval_95),
            probability(q(trend)),
            match (trend.found, trend.is_step) {
                (true, true) => "step",
                (true, false) => "yes",
                (false, _) => "no",
            }
            .to_owned(),
            trend.since.as_deref().filter(|_| trend.found).map_or(NONE, day).to_owned(),
            shown(&trend.unit, trend.level),
            trend.starts.to_string(),
            trend.runs.to_string(),
        ]
    });
    let numbers = ["a day", "95 %", "q", "found", "since", "at first", "starts", "runs"];
    Table::new(&["machine", "joint", "metric", "unit"], &numbers, rows)
}

pub(crate) fn effect(effect: &Effect, most: usize) -> Document {
    let what = effect.what.as_ref().map(|what| format!(", {what}")).unwrap_or_default();
    let Effect { machine, runs_after, .. } = effect;
    let (before, at) = (counted(effect.runs_before, "run"), day(&effect.at));
    let first = format!("{machine}{what}: {before} before {at}, {runs_after} after.");
    let mut section = Section::plain(Id::SUMMARY, [Sentence::finding(first)]);
    section = section.with_all(effect.between.iter().map(|note| {
        let (when, more) =
            if note.at < effect.at { ("before", "; `--since DATE` takes them") } else { ("after", "") };
        Sentence::note(format!("Runs {when} {} ({}) are left out{more}.", day(&note.at), note.what))
    }));
    section = section.with_all(effect.together.iter().map(|note| {
        let other = format!("{} ({})", day(&note.at), note.what);
        Sentence::note(format!(
            "Fewer than three runs lie between it and {other}: the effect is that of both."
        ))
    }));
    let found: Vec<&JointEffect> = effect.effects.iter().filter(|effect| effect.found).collect();
    let nothing = "Nothing to judge: no joint has three runs of one plan before and after.";
    let none = if effect.effects.is_empty() { nothing } else { "No effect found." };
    section = section.with_all(found.is_empty().then(|| Sentence::finding(none)));
    section = section.with_all(found.into_iter().take(most).map(|one| {
        let became = if one.change > 0.0 { "larger" } else { "smaller" };
        let unit = shown_unit(&one.unit);
        let others = match one.usual_change {
            Some(_) if one.of > 1 => format!("change {} of {} machines", one.rank, one.of),
            Some(_) => "less what other joints of other machines did".to_owned(),
            None => "no season is taken off, for fewer than three other machines tell it".to_owned(),
        };
        let ends = [("since", &one.since), ("until", &one.until)];
        let ends = ends.into_iter().filter_map(|(word, at)| Some(format!("{word} {}", day(at.as_deref()?))));
        let part = match ends.collect::<Vec<_>>().join(" and ") {
            none if none.is_empty() => none,
            ends => format!("; of runs {ends}, for its level changed by itself beyond"),
        };
        let drift = one.drift_per_day.map_or(String::new(), |drift| {
            format!("; beside {} {unit} a day, before as after", shown_rate(&one.unit, drift))
        });
        Sentence::finding(format!(
            "{}: the {} became {became} by {} {unit} ({} {unit}, 95 %), from {} {unit}; {others}{part}{drift}; q = {}.",
            one.joint,
            name(one.metric),
            shown_change(&one.unit, one.change.abs()).trim_start_matches('+'),
            interval(&one.unit, one.interval_95),
            shown(&one.unit, one.before),
            probability(one.q_value),
        ))
    }));
    let drifting = effect.effects.iter().filter(|one| !one.found && one.drift_per_day.is_some());
    section = section.with_all(drifting.take(most).map(|one| {
        Sentence::finding(format!(
            "{}: the {} changes by {} {} a day, before as after; no effect beside that.",
            one.joint,
            name(one.metric),
            shown_rate(&one.unit, one.drift_per_day.unwrap_or_default()),
            shown_unit(&one.unit),
        ))
    }));
    if !effect.effects.is_empty() {
        section = section.with(effects(effect.effects.iter().take(most)));
    }
    section = section.with_all(more(effect.effects.len(), most));
    let note = "Change: after minus before at the same starts of the same plan, less what the other machines changed by in \
                the same time (usual).";
    Document::default().with(section.with(Sentence::note(note))).remarked(&effect.remarks)
}

fn effects<'a>(effects: impl Iterator<Item = &'a JointEffect>) -> Table {
    let rows = effects.map(|one| {
        vec![
            one.joint.clone(),
            name(one.metric).to_owned(),
            shown_unit(&one.unit).to_owned(),
            shown(&one.unit, one.before),
            shown_change(&one.unit, one.change),
            interval(&one.unit, one.interval_95),
            one.usual_change.map_or(NONE.to_owned(), |usual| shown_change(&one.unit, usual)),
            format!("{} of {}", one.rank, one.of),
            probability(one.q_value),
            if one.found { "yes" } else { "no" }.to_owned(),
            one.starts.to_string(),
        ]
    });
    let numbers = ["before", "change", "95 %", "usual", "rank", "q", "found", "starts"];
    Table::new(&["joint", "metric", "unit"], &numbers, rows)
}

pub(crate) fn gate(gated: &Gated) -> Document {
    let section = Section::plain(Id::SUMMARY, gate_verdicts(gated))
        .with_all(not_judged(gated.too_few, gated.fewest_runs));
    Document::default().with(section).remarked(&gated.remarks)
}

pub(crate) fn gate_verdicts(gated: &Gated) -> Vec<Sentence> {
    gated.gates.iter().map(|gate| verdict(gate, gated.fewest_runs)).collect()
}

fn verdict(gate: &GateResult, fewest_runs: usize) -> Sentence {
    let unit = shown_unit(&gate.unit);
    let most = shown_change(&gate.unit, gate.most_per_day);
    let limit =
        format!("{} growth of {} {unit} a day at most", name(gate.metric), most.trim_start_matches('+'));
    let has = format!("has {} of one plan", counted(fewest_runs, "run"));
    let found = match &gate.worst {
        None => match gate.unit.as_str() {
            "m" => format!("nothing to judge: no joint that slides {has}"),
            "rad" => format!("nothing to judge: no joint that turns {has}"),
            _ => format!("nothing to judge: no joint {has}"),
        },
        Some(worst) => {
            let grows = match step_of(worst) {
                // A limit is on what a day brings.
                Some(step) => {
                    let growth = shown_change(&worst.unit, worst.growth_per_day());
                    format!("{growth} {unit} a day: {}", stepped(worst, step))
                }
                None => format!("{} {unit} a day", shown_rate(&worst.unit, worst.slope_per_day)),
            };
            let sure = if worst.found { "found" } else { "not proven" };
            let above = worst.growth_per_day() > gate.most_per_day;
            let start =
                if above && !worst.found { "no growth above it is proven; the largest is " } else { "" };
            let (machine, joint, q) = (&worst.machine, worst.joint_and_direction(), probability(q(worst)));
            let trend = format!("{start}{grows} at {machine} {joint} ({sure}, q = {q})");
            let shared = gate.shared_per_day.map(|shared| (shared, shown_rate(&worst.unit, shared)));
            let trend = match shared {
                Some((growth, shown)) if growth > gate.most_per_day => {
                    format!("all machines alike grow by {shown} {unit} a day; beside that {trend}")
                }
                Some((_, shown)) => {
                    format!("{trend}, beside up to {shown} {unit} a day that all machines share")
                }
                None => trend,
            };
            match gate.also.as_slice() {
                [] => trend,
                also => format!("{trend}; also broken by {}", also.join(", ")),
            }
        }
    };
    Sentence::Verdict { limit, kept: gate.kept, found }
}
