//! The page of a fleet: machines by day, the trend of each joint that changes, numbers.

use maud::{Markup, html};

use super::{answers, day, name, shown, shown_change, shown_unit};
use crate::{
    render::kit::{
        self, Document, Id, clean, counted,
        page::{
            Chapter, Plots, blocks, card,
            chart::{Chart, Panel, Role, Series, Size, rounded},
            strip::{Row, intervals},
        },
        percent, probability,
    },
    workflow::fleet::{Drift, Effect, JointTrend, Map, MapCell, Worst},
};

const MOST_DRAWN: usize = 24;
const MOST_ROWS: usize = 200;

/// What changes, where and since when.
pub(crate) fn drift_page(drift: &Drift) -> String {
    let mut plots = Plots::default();
    let found: Vec<&JointTrend> = drift.trends.iter().filter(|trend| trend.found).collect();
    let headline = match found.len() {
        0 if drift.judged() == 0 => "Nothing to judge".to_owned(),
        0 => "No drift found".to_owned(),
        some => format!("{} found", counted(some, "drift")),
    };
    let class = if found.is_empty() { "open" } else { "bad" };
    let document = answers::drift(drift, MOST_ROWS).titled_as("Drift of the fleet");
    let summary = html! {
        div class="cards" {
            (card(class, "Verdict", &headline, &html! { p { "of " (counted(drift.trends.len(), "trend")) " that five runs or more tell" } }))
            (fleet(drift.runs, drift.machines))
            @if let Some(first) = found.first() {
                (card("bad", "Stands out most", &format!("{} {}", first.machine, first.joint_and_direction()),
                    &html! { p { (clean(&answers::said(first))) } }))
            }
        }
    };
    let mut chapters = vec![Chapter { id: "summary", heading: "In short", body: summary }];
    chapters.extend(days(&drift.maps));
    let drawn = html! {
        div class="side" {
            @for trend in found.iter().take(MOST_DRAWN) { div { (plots.place(chart(trend))) (pages(trend)) } }
        }
    };
    if !found.is_empty() {
        chapters.push(Chapter { id: "trends", heading: "What changes", body: drawn });
    }
    ends("drift", &document, chapters, &plots)
}

pub(crate) fn worst_page(worst: &Worst) -> String {
    let document =
        answers::worst(worst, MOST_ROWS).titled_as(&format!("Largest {} of the fleet", name(worst.by)));
    let first = worst.joints.first().map(|joint| {
        let body = html! { p { "95 % of its starts stay below " (shown(&joint.unit, joint.p95)) " " (shown_unit(&joint.unit)) } };
        let headline = format!(
            "{} {}: {} {}", joint.machine, joint.joint, shown(&joint.unit, joint.median), shown_unit(&joint.unit)
        );
        card("open", "Worst median", &headline, &body)
    });
    let summary = html! {
        div class="cards" { (fleet(worst.runs, worst.machines)) @if let Some(first) = first { (first) } }
    };
    let mut chapters = vec![Chapter { id: "summary", heading: "In short", body: summary }];
    chapters.extend(days(worst.map.as_slice()));
    ends("worst", &document, chapters, &Plots::default())
}

pub(crate) fn effect_page(effect: &Effect) -> String {
    let title = format!("{}: what changed on {}", effect.machine, day(&effect.at));
    let document = answers::effect(effect, MOST_ROWS).titled_as(&title);
    let units: std::collections::BTreeSet<&str> =
        effect.effects.iter().map(|one| one.unit.as_str()).collect();
    let rows = |unit: &str| -> Vec<Row> {
        let text = |change: f64, q: f64| {
            format!("{} {} (q = {})", shown_change(unit, change), shown_unit(unit), probability(q))
        };
        let own = effect.effects.iter().filter(|one| one.unit == unit);
        own.map(|one| Row {
            name: format!("{}, {}", one.joint, name(one.metric)),
            value: one.change,
            interval: Some(one.interval_95),
            text: text(one.change, one.q_value),
            strong: one.found,
        })
        .collect()
    };
    let body = html! {
        p class="hint" { "After minus before, with the 95 % interval; coloured where it is found. Less is better." }
        @for unit in &units { (intervals(&rows(unit))) }
    };
    let mut chapters = Vec::new();
    if !effect.effects.is_empty() {
        chapters.push(Chapter { id: "effects", heading: "Change by joint", body });
    }
    ends("effect", &document, chapters, &Plots::default())
}

fn fleet(runs: usize, machines: usize) -> Markup {
    card("open", "Looked at", &counted(runs, "run"), &html! { p { "of " (counted(machines, "machine")) } })
}

/// The last chapters of every page.
fn ends(kind: &str, document: &Document, mut chapters: Vec<Chapter>, plots: &Plots) -> String {
    chapters.push(Chapter { id: "numbers", heading: "Numbers", body: blocks(document.blocks(Id::SUMMARY)) });
    chapters.extend(Chapter::of(document.section(Id::REMARKS), "Remarks on the data"));
    kit::page::page(&format!("fleet {kind}"), document, &chapters, plots)
}

/// Machines by day; nothing of no map.
pub(in crate::render) fn days(maps: &[Map]) -> Option<Chapter> {
    let body = html! {
        p class="hint" {
            "Each cell is the worst joint of a machine in that time: by how many per cent its starts are above (+) or below (-) "
            "the median of all machines at the same starts of the same plan. Newest runs decide the order."
        }
        p class="legend" {
            @for (class, text) in LEVELS { span { i class={ "heat " (class) } {} (text) } }
        }
        @for map in maps { (heat(map)) }
    };
    (!maps.is_empty()).then_some(Chapter { id: "days", heading: "Machines by day", body })
}

/// Classes of cells and what they stand for, from the best to the worst.
const LEVELS: [(&str, &str); 6] = [
    ("heat-low", "10 % and more below"),
    ("heat0", "within 10 %"),
    ("heat1", "to 25 % above"),
    ("heat2", "to 50 %"),
    ("heat3", "to 100 %"),
    ("heat4", "more"),
];
const BOUNDS: [f64; 5] = [-0.1, 0.1, 0.25, 0.5, 1.0];

fn heat(map: &Map) -> Markup {
    let days = match map.days_a_column {
        1 => "by day".to_owned(),
        days => format!("{days} days a column"),
    };
    let heading = format!("{} in % against the fleet, {days}", name(map.metric));
    let cell = |machine: &str, at: &str, cell: &MapCell| {
        let class = LEVELS[BOUNDS.iter().filter(|bound| cell.above_fleet > **bound).count()].0;
        let (day, above, starts) = (day(at), percent(cell.above_fleet), counted(cell.starts, "start"));
        let title = format!("{machine} {}, {day}: {above} % against the fleet, {starts}", cell.joint);
        html! { td class=(class) title=(clean(&title)) { (above) } }
    };
    html! {
        h3 { (heading) }
        div class="scroll" tabindex="0" {
            table class="heatmap" {
                thead { tr { th { "machine" } @for at in &map.columns { th { (short(at)) } } } }
                tbody {
                    @for row in &map.machines {
                        tr {
                            th { (clean(&row.machine)) }
                            @for (at, one) in map.columns.iter().zip(&row.cells) {
                                @match one { Some(one) => { (cell(&row.machine, at, one)) } None => { td {} } }
                            }
                        }
                    }
                }
            }
        }
        @if map.left_out > 0 { p class="hint" { (counted(map.left_out, "machine")) " with better newest runs not listed." } }
    }
}

/// Month and day.
fn short(at: &str) -> &str {
    day(at).get(5..).unwrap_or_default()
}

/// Links to the pages of the runs, where these lie beside the logs.
fn pages(trend: &JointTrend) -> Markup {
    let pages = trend.levels.iter().filter_map(|level| {
        let page = level.page.as_deref()?;
        Some((level.log.rsplit('/').next().unwrap_or_default(), format!("file://{}", encoded(page))))
    });
    let pages: Vec<(&str, String)> = pages.collect();
    html! {
        @if !pages.is_empty() {
            p class="hint" { "Pages: " @for (name, link) in &pages { a href=(link) { (clean(name)) } " " } }
        }
    }
}

/// A path as part of an address.
fn encoded(path: &str) -> String {
    let plain = |b: u8| b.is_ascii_alphanumeric() || b"/-_.~".contains(&b);
    let letter = |b: u8| if plain(b) { char::from(b).to_string() } else { format!("%{b:02X}") };
    path.bytes().map(letter).collect()
}

/// The levels that a change was found in.
pub(in crate::render) fn chart(trend: &JointTrend) -> Chart {
    let unit = &trend.unit;
    let scale = match shown_unit(unit) {
        "deg" => 1f64.to_degrees(),
        _ => 1e3,
    };
    let first = trend.levels.first().map_or(0.0, |level| level.at_days);
    let xs: Vec<f64> = trend.levels.iter().map(|level| rounded(level.at_days - first)).collect();
    let y: Vec<f64> = trend.levels.iter().map(|level| rounded(level.value * scale)).collect();
    let names = trend.levels.iter().map(|level| level.log.rsplit('/').next().unwrap_or_default().to_owned());
    let centre = |values: &[f64]| crate::math::median(values.to_vec());
    let ends = [xs.first(), xs.last()].map(|x| x.copied().unwrap_or(0.0));
    let room = 0.03 * (ends[1] - ends[0]).max(1.0);
    let step = answers::step_of(trend).and_then(|step| {
        let (before, after) = (y.get(..step.runs_before)?, y.get(step.runs_before..)?);
        let mean = |side: &[f64]| rounded(side.iter().sum::<f64>() / side.len() as f64);
        let (last, first) = (*xs.get(step.runs_before.checked_sub(1)?)?, *xs.get(step.runs_before)?);
        let (before, after) = (mean(before), mean(after));
        let (at, line) = (vec![ends[0], last, first, ends[1]], vec![before, before, after, after]);
        Some((at, line, answers::stepped(trend, step)))
    });
    let course = || {
        let at = trend.line.iter().map(|[at, _]| rounded(at - first)).collect();
        let line = trend.line.iter().map(|[_, level]| rounded(level * scale)).collect();
        let what = trend.changes.last().map(|change| {
            let unit = shown_unit(unit);
            let by = |value| shown_change(&trend.unit, value);
            change.per_day.map_or_else(
                || format!("{} {unit} at last", by(change.change)),
                |(slope, _)| format!("{} {unit} a day at last", by(slope)),
            )
        });
        (at, line, what.unwrap_or_default())
    };
    let step = if trend.line.is_empty() { step } else { Some(course()) };
    // A rate is that of the days that it is said of; before, the level stays.
    let from = (ends[1] - trend.changing_days).clamp(ends[0], ends[1].max(ends[0]));
    let later: Vec<(f64, f64)> =
        xs.iter().copied().zip(y.iter().copied()).filter(|(x, _)| *x >= from - 0.5).collect();
    let (later_x, later_y): (Vec<f64>, Vec<f64>) = later.into_iter().unzip();
    let (x0, y0) = (centre(&later_x), centre(&later_y));
    let (guide, at, line, what) = step.map_or_else(
        || {
            let at = [ends[0], rounded(from), ends[1]].to_vec();
            let level = |x: &f64| rounded(y0 + trend.slope_per_day * scale * (x.max(from) - x0));
            let what = format!("{} {} a day", shown_change(unit, trend.slope_per_day), shown_unit(unit));
            ("slope", at.clone(), at.iter().map(level).collect(), what)
        },
        |(at, line, what)| ("level", at, line, what),
    );
    let runs = Series::of("run", Role::Point, 0, y).named(names.collect());
    let series = vec![Series::of(guide, Role::Guide, 1, line), runs];
    Chart {
        title: format!("{} {}: {}", trend.machine, trend.joint_and_direction(), name(trend.metric)),
        note: format!("{what}, q = {}", probability(answers::q(trend))),
        x_label: "days since the first run".into(),
        x_range: Some([ends[0] - room, ends[1] + room]),
        xs: vec![xs, at],
        panels: vec![Panel::of(format!("{} {}", name(trend.metric), shown_unit(unit)), 1.0, series)],
        height: 190,
        size: Size::Half,
        ..Chart::default()
    }
}
