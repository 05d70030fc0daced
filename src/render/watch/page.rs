//! The index: all runs with their verdicts, and the trend of each joint.

use std::collections::{BTreeMap, BTreeSet};

use maud::{Markup, html};

use super::{began, delay, peak, verdict};
use crate::{
    render::{
        fleet::{chart as level, days, said},
        kit::{
            self, Document, NONE, Section, clean, counted, fact,
            page::{
                Chapter, Plots, blocks, card,
                chart::{Chart, Panel, Role, Series, Size, rounded},
            },
        },
        metric::{on_paper, unit, with_unit},
    },
    replay::Dimension,
    series::JointKind,
    workflow::{
        fleet::{Drift, JointTrend},
        report::GateResult,
        watch::{Index, Run, RunJoint, Verdict},
    },
};

const MOST_DRAWN: usize = 120;
/// Changes of a machine whose levels are drawn.
const MOST_FOUND: usize = 6;
/// Runs of a trend that are drawn, the newest.
const MOST_RUNS: usize = 400;

pub(crate) fn index(index: &Index<'_>) -> String {
    let (done, failed): (Vec<&Run>, Vec<&Run>) = index.runs.iter().partition(|run| run.page.is_some());
    let mut plots = Plots::default();
    let mut document = Document::titled(match done.len() {
        0 => "No run yet".to_owned(),
        some => counted(some, "run"),
    });
    let ends = [("newest", done.first()), ("oldest", done.last())];
    document.facts.extend(ends.into_iter().filter_map(|(name, run)| Some(fact(name, began(run?)))));
    let mut chapters =
        vec![Chapter { id: "summary", heading: "In short", body: summary(index, &done, &failed) }];
    if !done.is_empty() {
        chapters.push(Chapter { id: "runs", heading: "Runs", body: table(&done) });
    }
    if !failed.is_empty() {
        chapters.push(Chapter { id: "failed", heading: "Logs without a report", body: failures(&failed) });
    }
    if !done.is_empty() {
        let body = trends(&done, index.drift.as_ref(), &mut plots);
        chapters.push(Chapter { id: "trends", heading: "Trends", body });
    }
    if let Some(drift) = &index.drift {
        chapters.extend(days(&drift.maps).filter(|_| drift.machines > 1));
        chapters.extend(Chapter::of(Section::remarks(&drift.remarks).as_ref(), "Remarks on the data"));
    }
    kit::page::page("watch", &document, &chapters, &plots)
}

fn summary(index: &Index<'_>, done: &[&Run], failed: &[&Run]) -> Markup {
    let of = |verdict: Verdict| done.iter().filter(|run| run.verdict == verdict).count();
    let (kept, broken) = (of(Verdict::Kept), of(Verdict::NotKept));
    let (class, headline) = match (kept, broken) {
        (0, 0) => ("open", "No limits set".to_owned()),
        (kept, 0) => ("good", format!("{} within limits", counted(kept, "run"))),
        (kept, broken) => ("bad", format!("{broken} of {} NOT within limits", counted(kept + broken, "run"))),
    };
    html! {
        div class="cards" {
            (card(class, "Verdict", &headline, &html! {
                @for limit in limits(done) { p { (limit) } }
                @if kept + broken == 0 {
                    p { "Limits such as " code { "--max-transition-peak-deg 0.5" } " make verdicts." }
                }
            }))
            @if let Some(newest) = done.first() {
                (card("", "Newest run", &newest.worst().map_or(NONE.to_owned(), |worst| format!("{}: {}", worst.joint, peak(worst))),
                    &html! { p { (link(newest)) ", " (began(newest)) ", " (verdict(newest.verdict)) } }))
            }
            @if let Some(drift) = &index.drift { (drift_card(drift)) }
            @if !failed.is_empty() {
                (card("bad", "Without a report", &counted(failed.len(), "log"), &html! { p { a href="#failed" { "Why" } } }))
            }
        }
    }
}

/// The limits of the newest run that has some.
fn limits(done: &[&Run]) -> Vec<String> {
    let gates = done.iter().map(|run| &run.gates).find(|gates| !gates.is_empty());
    let said = |gate: &GateResult| {
        format!("Limit on {}: {}", gate.gate.name, with_unit(gate.gate.dimension, gate.kind(), gate.limit))
    };
    gates.into_iter().flatten().map(said).collect()
}

/// What was found against a limit that is not kept.
fn over(gate: &GateResult) -> String {
    let shown = |value: f64| with_unit(gate.gate.dimension, gate.kind(), value);
    let Some(joint) = &gate.joint else { return "nothing to judge".to_owned() };
    let worst = gate.worst.map_or(gate.gate.missing.to_owned(), shown);
    format!("{joint}: {worst}, {} allowed", shown(gate.limit))
}

fn drift_card(drift: &Drift) -> Markup {
    let found: Vec<_> = drift.trends.iter().filter(|trend| trend.found).collect();
    let (class, headline) = match (drift.trends.len(), found.len()) {
        (0, _) => ("", "Too early to tell".to_owned()),
        (_, 0) => ("good", "None found".to_owned()),
        (_, some) => ("bad", format!("{} found", counted(some, "drift"))),
    };
    let why = match (drift.trends.len(), found.first()) {
        (0, _) => "Five runs of one plan, of a machine that is named, are the least.".to_owned(),
        (_, Some(first)) => said(first),
        (all, None) => format!("among {}", counted(all, "trend")),
    };
    card(class, "Drift", &headline, &html! { p { (clean(&why)) } })
}

fn link(run: &Run) -> Markup {
    html! { a href=[run.page.as_deref()] title=(clean(&run.log)) { (clean(run.name())) } }
}

fn machine(run: &Run) -> &str {
    run.machine.as_deref().unwrap_or(NONE)
}

fn table(runs: &[&Run]) -> Markup {
    let class = |run: &Run| match run.verdict {
        Verdict::Kept => "word good",
        Verdict::NotKept => "word bad",
        _ => "word",
    };
    html! {
        div class="scroll" tabindex="0" {
            table {
                thead { tr {
                    th { "began (UTC)" } th { "log" } th { "machine" } th { "verdict" } th { "worst joint" }
                    th class="number" { "peak error" } th class="number" { "longest dead time" }
                    th class="number" { "never answered" } th class="number" { "remarks" }
                } }
                tbody {
                    @for run in runs {
                        tr {
                            td { (began(run)) } td { (link(run)) } td { (clean(machine(run))) }
                            td class=(class(run)) {
                                @if run.verdict == Verdict::NoLimits { (verdict(run.verdict)) }
                                @else { span class="mark" { (verdict(run.verdict)) } }
                                @for gate in run.gates.iter().filter(|gate| !gate.kept) { p { (clean(&over(gate))) } }
                            }
                            td { (clean(run.worst().map_or(NONE, |worst| &worst.joint))) }
                            td class="number" { (run.worst().map_or(NONE.to_owned(), peak)) }
                            td class="number" {
                                (delay(run.largest_delay_s))
                                @if let Some(joint) = run.latest() { " (" (clean(&joint.joint)) ")" }
                            }
                            td class={ "number" @if run.unanswered_starts > 0 { " bad" } } { (number(run.unanswered_starts)) }
                            td class="number" { (number(run.remarks)) }
                        }
                    }
                }
            }
        }
    }
}

/// Nothing to see of none.
fn number(count: usize) -> String {
    if count > 0 { count.to_string() } else { String::new() }
}

fn failures(runs: &[&Run]) -> Markup {
    let facts = runs.iter().map(|run| fact(run.log.clone(), run.error.clone().unwrap_or_default()));
    blocks(&[kit::Block::Facts(facts.collect())])
}

/// Each joint of each machine over its runs.
fn trends(done: &[&Run], drift: Option<&Drift>, plots: &mut Plots) -> Markup {
    let dated: Vec<(&Run, f64)> = done.iter().filter_map(|run| Some((*run, run.at_days()?))).collect();
    let first = dated.last().map_or(0.0, |(_, at_days)| *at_days);
    let span = dated.first().map_or(0.0, |(_, at_days)| *at_days) - first;
    let (time_unit, scale) = if span < 2.0 { ("hours", 24.0) } else { ("days", 1.0) };
    let range = [-0.04, 1.04].map(|share| share * (span * scale).max(0.1));
    let mut machines: BTreeMap<&str, BTreeMap<(&str, JointKind), Vec<Point<'_>>>> = BTreeMap::new();
    for (run, at_days) in dated.iter().rev() {
        for joint in &run.joints {
            let point = Point { x: rounded((at_days - first) * scale), plan: run.plan_id.as_deref(), joint };
            machines
                .entry(machine(run))
                .or_default()
                .entry((&joint.joint, joint.kind))
                .or_default()
                .push(point);
        }
    }
    let all: usize = machines.values().map(BTreeMap::len).sum();
    let mut left = MOST_DRAWN;
    html! {
        p class="hint" {
            "Each run of each joint: above its peak error, below its longest dead time in ms, over " (time_unit) " since "
            (dated.last().map_or(NONE.to_owned(), |(run, _)| began(run))) ". A line joins the runs of one plan; those of another differ \
             without any change of the machine. A drift is told by the same starts of the same plan, from five runs of a machine on, and drawn above as what these did."
            @if dated.len() < done.len() {
                " " (counted(done.len() - dated.len(), "run")) " without a date, in stamps or name, not drawn."
            }
            @if all > MOST_DRAWN { " " (counted(all - MOST_DRAWN, "joint")) " not drawn." }
        }
        @for (machine, joints) in &machines {
            @if left > 0 {
                h3 { @if *machine == NONE { "No machine named" } @else { (clean(machine)) } }
                @let found = drifts(drift, machine);
                @for trend in &found { p { (clean(&said(trend))) } }
                div class="side" { @for trend in found.iter().take(MOST_FOUND) { (plots.place(level(trend))) } }
                div class="tiles" {
                    @for (name, points) in joints.iter().take(left) { (plots.place(chart(*name, points, range))) }
                }
            }
            @let () = left = left.saturating_sub(joints.len());
        }
    }
}

fn drifts<'a>(drift: Option<&'a Drift>, machine: &str) -> Vec<&'a JointTrend> {
    let trends = drift.into_iter().flat_map(|drift| &drift.trends);
    trends.filter(|trend| trend.found && trend.machine == machine).collect()
}

struct Point<'a> {
    x: f64,
    plan: Option<&'a str>,
    joint: &'a RunJoint,
}

fn chart((joint, kind): (&str, JointKind), points: &[Point<'_>], range: [f64; 2]) -> Chart {
    let points = &points[points.len().saturating_sub(MOST_RUNS)..];
    let peaks: &dyn Fn(&Point<'_>) -> f64 = &|point| rounded(on_paper(kind, point.joint.peak));
    let delays: &dyn Fn(&Point<'_>) -> f64 =
        &|point| point.joint.largest_delay_s.map_or(f64::NAN, |s| rounded(1e3 * s));
    // All points, then those of each plan, which a line joins.
    let mut groups: Vec<Vec<&Point<'_>>> = vec![points.iter().collect()];
    let plans: BTreeSet<&str> = points.iter().filter_map(|point| point.plan).collect();
    groups.extend(plans.into_iter().map(|plan| points.iter().filter(|p| p.plan == Some(plan)).collect()));
    let panel = |label: &str, of: &dyn Fn(&Point<'_>) -> f64| {
        let series = groups.iter().enumerate().map(|(x, group)| {
            let role = if x == 0 { Role::Point } else { Role::Guide };
            Series::of("", role, x, group.iter().map(|p| of(p)).collect())
        });
        let most = points.iter().map(of).filter(|y| y.is_finite()).fold(1e-3, f64::max);
        Panel {
            range: Some([0.0, 1.1 * most]),
            label: label.to_owned(),
            // Points above lines.
            series: series.rev().collect(),
            share: 1.0,
        }
    };
    let newest = points.last().map_or(String::new(), |point| {
        format!("newest {}, {}", peak(point.joint), delay(point.joint.largest_delay_s))
    });
    Chart {
        title: joint.to_owned(),
        note: newest,
        xs: groups.iter().map(|group| group.iter().map(|point| point.x).collect()).collect(),
        x_range: Some(range),
        panels: vec![
            panel(&format!("peak {}", unit(Dimension::Position, kind)), peaks),
            panel("dead time ms", delays),
        ],
        height: 150,
        size: Size::Tile,
        ..Chart::default()
    }
}
