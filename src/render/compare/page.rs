//! The page of a comparison.

use std::path::PathBuf;

use maud::{Markup, html};

use super::{
    kind, scope,
    short::{plans, verdicts},
    steps::steps,
    tables::document,
    together, together_name,
};
use crate::{
    render::{
        kit::{
            self, Id, Sentence, capital, clean, mm,
            page::{
                Chapter, Plots, card,
                chart::{Chart, Panel, Role, Series, at, rounded, span, times},
                envelope::envelope,
                headed, next_steps,
                strip::{Row, intervals},
                verdict,
            },
            percent, probability, signed,
        },
        metric::{number, on_paper, position, unit},
    },
    replay::{Dimension, Keyed, Metric, PEAK_ERROR, Transition},
    series::{JointKind, Pair},
    workflow::compare::{Change, Comparison, Figures, Idle, Scope, TransitionPair, Verdict},
};

/// Places of a series at most, nearly.
const MOST: usize = 4000;

/// What a change did, as one page; `most` is how many pairs its table lists.
///
/// `logs` are those of both sides as the caller named them, `read` the options with which they were read.
pub(crate) fn page(comparison: &Comparison, most: usize, logs: [&[PathBuf]; 2], read: &[String]) -> String {
    let document = document(comparison, most);
    let apart = [Id::REMARKS, Id::METHOD];
    let numbers = document.sections.iter().filter(|section| !apart.contains(&section.id));
    let mut plots = Plots::default();
    let mut chapters =
        vec![Chapter { id: "summary", heading: "In short", body: summary(comparison, logs, read) }];
    if comparison.idle() != Some(Idle::NoPair) {
        chapters.extend([
            Chapter { id: "pairs", heading: "Every transition", body: scatters(comparison, &mut plots) },
            Chapter { id: "joints", heading: "Error over the run", body: runs(comparison, &mut plots) },
        ]);
    }
    let numbers = html! { @for section in numbers { (headed(section)) } };
    chapters.push(Chapter { id: "numbers", heading: "Numbers", body: numbers });
    chapters.extend(Chapter::of(document.section(Id::REMARKS), "Remarks on the data"));
    chapters.extend(Chapter::of(document.section(Id::METHOD), "Method"));
    kit::page::page("comparison", &document, &chapters, &plots)
}

fn summary(comparison: &Comparison, logs: [&[PathBuf]; 2], read: &[String]) -> Markup {
    let kept: Vec<bool> = comparison.gates.iter().map(|gate| gate.kept).collect();
    let lines: Vec<String> = verdicts(comparison).iter().map(Sentence::to_string).collect();
    if let Some(idle) = comparison.idle() {
        let headline = if idle == Idle::NoPair { "Not comparable" } else { "The same run twice" };
        let why = match idle {
            Idle::NoPair => {
                let none = "No planned start of one side has a counterpart in the other.";
                format!("{none} {}", plans(comparison))
            }
            Idle::SameRun => {
                "Both sides are one and the same run: their difference says nothing of a change.".to_owned()
            }
        };
        let body = html! { p { (clean(&why)) } p { a href="#remarks" { "Remarks on the data" } } };
        return html! {
            div class="cards" { (card("care", "Peak error at transitions", headline, &body)) (verdict(&kept, &lines)) }
            (next_steps(&steps(comparison, logs, read)))
        };
    }
    html! {
        div class="cards" {
            (change(comparison))
            (verdict(&kept, &lines))
            @for all in together(comparison) { (whole_run(all)) }
            (at_the_tool(comparison))
        }
        (next_steps(&steps(comparison, logs, read)))
        h3 { "Mean change of the peak error, with its 95 % interval" }
        @for all in together(comparison) { (intervals(&change_rows(comparison, all.kind))) }
    }
}

fn change(comparison: &Comparison) -> Markup {
    let (class, headline) = match comparison.verdict {
        Verdict::Smaller => ("good", "Peaks became smaller"),
        Verdict::Larger => ("bad", "Peaks became larger"),
        Verdict::Mixed => ("open", "Most changed one way, a few by much the other way"),
        Verdict::NotShown => ("open", "No change shown"),
        Verdict::Equal => ("open", "Nothing changed"),
        Verdict::TooFew => ("open", "Too few to tell"),
    };
    let body = html! {
        @for peak in comparison.overall(PEAK_ERROR) {
            @let kind = kind(comparison, &peak.scope);
            @if let (Some(before), Some(after)) = (peak.mean_before, peak.mean_after) {
                p {
                    (format!("mean {} -> {}", position(kind, before), position(kind, after)))
                    (peak.relative_change.map_or(String::new(), |share| format!(" ({} %)", percent(share))))
                }
            }
            p { (format!("p = {}; {} smaller, {} larger of {} pairs", probability(peak.p_value), peak.smaller, peak.larger, peak.pairs)) }
        }
    };
    card(class, "Peak error at transitions", headline, &body)
}

fn whole_run(all: &Figures) -> Markup {
    let arrow = |key: &str| match all.changes.get(key) {
        Change { before: Some(before), after: Some(after), .. } => {
            format!("{} -> {}", position(all.kind, before), position(all.kind, after))
        }
        _ => "not known".to_owned(),
    };
    let body = html! {
        p { "peak " (arrow("peak")) }
        p { "rms at standstill " (arrow("standstill_rms")) }
    };
    let whose = if all.scope == Scope::All { "whole run" } else { together_name(&all.scope) };
    card("", &format!("Rms error, {whose}"), &arrow("rms"), &body)
}

fn at_the_tool(comparison: &Comparison) -> Markup {
    let Some(tool) = &comparison.tool else { return html! {} };
    let arrow = |key: &str| {
        let change = tool.get(key);
        let both = change.before.zip(change.after);
        both.map(|(before, after)| format!("{} -> {} mm", mm(before), mm(after)))
    };
    let body = html! {
        @for (name, key) in [("rms", "rms_m"), ("at rest at the end", "end_m"), ("at dwells", "dwell_m")] {
            @if let Some(arrow) = arrow(key) { p { (name) " " (arrow) } }
        }
    };
    card("", "At the tool, at worst", &arrow("worst_m").unwrap_or_default(), &body)
}

/// Mean changes of the peak error of joints of a kind, degrees or millimetres: of all pairs, of starts from rest, of each joint.
pub(super) fn change_rows(comparison: &Comparison, of: JointKind) -> Vec<Row> {
    let is = |scope: &Scope| kind(comparison, scope) == of;
    let of = comparison.summaries.iter().filter(|summary| summary.measure.key == PEAK_ERROR);
    let of = of.filter(|summary| is(&summary.scope));
    let rows = of.filter_map(|summary| {
        let mean = summary.mean_difference?;
        let interval = summary.interval_95;
        let kind = kind(comparison, &summary.scope);
        let alone = |d: f64| signed(d, |d| number(Dimension::Position, kind, d));
        let between = interval.map_or(String::new(), |[a, b]| format!(" ({}..{})", alone(a), alone(b)));
        Some(Row {
            name: scope(&summary.scope),
            value: on_paper(kind, mean),
            interval: interval.map(|ends| ends.map(|end| on_paper(kind, end))),
            text: signed(mean, |d| position(kind, d)) + &between,
            strong: summary.scope == Scope::All,
        })
    });
    rows.collect()
}

fn scatters(comparison: &Comparison, plots: &mut Plots) -> Markup {
    html! {
        p class="hint" { "Each point is one transition; below the line it became smaller." }
        div class="side" { @for (_, chart) in pair_charts(comparison) { (plots.place(chart)) } }
    }
}

/// Every pair of transitions, after over before: a chart for each metric that is compared.
pub(super) fn pair_charts(comparison: &Comparison) -> Vec<(String, Chart)> {
    let kinds: Vec<JointKind> = together(comparison).map(|all| all.kind).collect();
    let chart = |(metric, of): (&'static Metric<Transition>, JointKind)| {
        let apart = metric.dimension.is_of_joint() && kinds.len() > 1;
        let unit = unit(metric.dimension, of);
        let place = |value: f64, pair: &TransitionPair| {
            let of_joint = metric.dimension.is_of_joint();
            rounded(if of_joint { on_paper(pair.joint_kind, value) } else { 1e3 * value })
        };
        let labels = ["before", "after"].map(|side| format!("{} {side} ({unit})", capital(metric.name)));
        let whose = match (apart, of) {
            (false, _) => "",
            (true, JointKind::Turns) => ", joints that turn",
            (true, JointKind::Slides) => ", joints that slide",
        };
        let name = format!("{}{whose}", metric.name);
        let chart = scatter(comparison, &capital(&name), labels, |pair| {
            let change = pair.changes.get(metric.key);
            let both = change.before.zip(change.after).filter(|_| !apart || pair.joint_kind == of);
            both.map(|(before, after)| [before, after].map(|value| place(value, pair)))
        });
        (name, chart)
    };
    let kinds_of = |metric: &Metric<Transition>| {
        let all = if metric.dimension.is_of_joint() { kinds.len() } else { 1 };
        kinds.iter().copied().take(all)
    };
    let rows = Metric::<Transition>::rows().into_iter();
    rows.flat_map(|metric| kinds_of(metric).map(move |kind| (metric, kind))).map(chart).collect()
}

fn scatter(
    comparison: &Comparison,
    title: &str,
    labels: [String; 2],
    of: impl Fn(&TransitionPair) -> Option<[f64; 2]>,
) -> Chart {
    let named = |pair: &TransitionPair| {
        let direction = number(Dimension::Sign, pair.joint_kind, f64::from(pair.direction));
        format!("{} {} {direction} {:.2} s", pair.joint, pair.kind.name(), pair.planned_onset_before_s)
    };
    let pairs: Vec<(String, [f64; 2])> =
        comparison.pairs.iter().filter_map(|pair| Some((named(pair), of(pair)?))).collect();
    let [low, high] = span(pairs.iter().flat_map(|(_, both)| *both).chain([0.0]));
    let ends =
        [rounded(low - 0.05 * (high - low) * f64::from(low < 0.0)), rounded(high + 0.05 * (high - low))];
    let chart = Chart::against(labels, ["no change", "transition"], ends, pairs);
    Chart { title: title.to_owned(), height: 360, ..chart }
}

fn runs(comparison: &Comparison, plots: &mut Plots) -> Markup {
    html! {
        p class="hint" {
            "Planned minus measured, of the first run of each side; the run after is shifted so that both plans start \
             together. Drag to zoom, double-click for the whole run."
        }
        @for (joint, chart) in error_charts(comparison) {
            div class="joint" data-name=(clean(&joint)) { (plots.place(chart)) }
        }
    }
}

/// Joints with their errors before and after, on the clock of the first run before.
pub(super) fn error_charts(comparison: &Comparison) -> Vec<(String, Chart)> {
    let offset_s = comparison.after.first().map_or(0.0, |run| run.offset_s);
    let [before, after] = &comparison.samples;
    let chart = |joint: &String| {
        let (before, after) = (named(before, joint)?, named(after, joint)?);
        Some((joint.clone(), over_time(joint, before, after, offset_s)))
    };
    comparison.joints.iter().filter_map(chart).collect()
}

fn named<'a>(pairs: &'a [Pair], joint: &str) -> Option<&'a Pair> {
    pairs.iter().find(|pair| pair.name == joint)
}

fn over_time(joint: &str, before: &Pair, after: &Pair, offset_s: f64) -> Chart {
    let mut xs = Vec::new();
    let mut series = |name: &str, role, pair: &Pair, shift_s: f64| {
        let error: Vec<f64> = pair.planned.iter().zip(&pair.measured).map(|(p, m)| p - m).collect();
        let places = envelope(&pair.segments, &[&error], MOST);
        xs.push(times(&pair.t_s, &places).into_iter().map(|t_s| rounded(t_s - shift_s)).collect());
        let y = at(&error, &places).map(|value| rounded(on_paper(pair.kind, value))).collect();
        Series::of(name, role, xs.len() - 1, y)
    };
    let series =
        vec![series("before", Role::Before, before, 0.0), series("after", Role::Measured, after, offset_s)];
    Chart {
        title: joint.to_owned(),
        x_label: "Time (s)".into(),
        xs,
        panels: vec![Panel::of(format!("Error ({})", unit(Dimension::Position, before.kind)), 1.0, series)],
        group: Some("run"),
        height: 190,
        ..Chart::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::workflow::compare::{Inputs, run};

    #[test]
    fn the_page_of_runs_that_are_no_comparison_says_so() {
        let log = |name: &str| {
            vec![std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("sample-logs").join(name)]
        };
        let compared = |after: &str| {
            run(&Inputs { before: log("task-1-run.mcap"), after: log(after), ..Inputs::default() }).unwrap()
        };
        assert!(!page(&compared("task-1-run.mcap"), 60, [&[], &[]], &[]).contains("Nothing changed"));
        let mut other = compared("precompensated-run.mcap");
        other.pairs.clear();
        other.same_plan = false;
        let page = page(&other, 60, [&[], &[]], &[]);
        assert!(page.contains("Not comparable") && !page.contains("Rms error, whole run"));
    }
}
