//! Small multiples: every transition from its own planned start, worst first.

use maud::{Markup, html};

use crate::{
    render::{
        kit::{
            counted, late,
            page::{
                Plots, Shows,
                chart::{Band, Chart, Panel, Role, Series, Shade, Size, at, rounded, span, times},
                envelope::envelope,
            },
        },
        metric::{number, on_paper, position, unit},
    },
    replay::{Answer, Dimension, Transition},
    series::{JointKind, Pair},
    workflow::report::Report,
};

pub(super) const MOST: usize = 48;
/// Places of a series at most, nearly.
const PLACES: usize = 300;
/// Shown before the planned start, s.
const BEFORE_S: f64 = 0.3;
/// Shown after it at most, s.
const AFTER_S: f64 = 3.0;

pub(super) fn transitions(report: &Report, plots: &mut Plots) -> Markup {
    let tiles = tiles(report);
    let left = report.replay.transitions.len().saturating_sub(tiles.len());
    if tiles.is_empty() {
        return html! { p { "No planned start from rest was found." } };
    }
    html! {
        p class="hint" {
            "Every planned start, from the instant of the plan, worst first. Above: planned and measured position from there, \
             upwards in the direction of motion; below: how far the joint is behind, on one scale for all"
            @if report.replay.of_kinds.len() > 1 { " of a unit" }
            ". Shaded until the joint leaves rest, in red where it never does. A click shows it in the whole run."
            @if left > 0 { " " (counted(left, "smaller one")) " not drawn." }
        }
        div class="tiles" {
            @for (transition, chart) in tiles {
                @let shows = Shows::around(&transition.joint, transition.window_s);
                div class="goto" role="button" tabindex="0" data-from=(shows.from) data-to=(shows.to) data-joint=(shows.joint) {
                    (plots.place(chart))
                }
            }
        }
    }
}

/// Transitions with their plots, worst first.
pub(super) fn tiles(report: &Report) -> Vec<(&Transition, Chart)> {
    let worst = report.replay.worst_first().into_iter().take(MOST);
    let mut tiles: Vec<(&Transition, Chart)> = worst
        .filter_map(|transition| {
            let pair = report.pairs.iter().find(|pair| pair.name == transition.joint)?;
            Some((transition, tile(transition, pair, [BEFORE_S, AFTER_S])))
        })
        .collect();
    let scale = |kind: JointKind| {
        let own = tiles.iter().filter(|(transition, _)| transition.joint_kind == kind);
        let errors = own.filter_map(|(_, chart)| chart.panels.last());
        let values = errors.flat_map(|panel| panel.series.iter().flat_map(|series| &series.y)).copied();
        let [low, high] = span(values.chain([0.0]));
        let room = 0.06 * (high - low);
        [rounded(low - room), rounded(high + room)]
    };
    let [turning, sliding] = [JointKind::Turns, JointKind::Slides].map(scale);
    let to_s = tiles.iter().map(|(_, chart)| chart.span()[1]).fold(0.0, f64::max);
    for (transition, chart) in &mut tiles {
        chart.x_range = Some([-BEFORE_S, to_s.max(BEFORE_S)]);
        if let Some(panel) = chart.panels.last_mut() {
            panel.range = Some(if transition.joint_kind == JointKind::Turns { turning } else { sliding });
        }
    }
    tiles
}

/// A start from its planned instant, so long before and after it at most, s.
pub(super) fn tile(transition: &Transition, pair: &Pair, [before_s, after_s]: [f64; 2]) -> Chart {
    let onset_s = transition.planned_onset_s;
    let sign = f64::from(transition.direction);
    let from = pair.t_s.partition_point(|t_s| *t_s < onset_s - before_s);
    let to = pair.t_s.partition_point(|t_s| *t_s <= transition.window_s[1].min(onset_s + after_s));
    let within = |values: &[f64]| values.get(from..to.max(from)).unwrap_or_default().to_vec();
    let (planned, measured) = (within(&pair.planned), within(&pair.measured));
    let t_s: Vec<f64> = within(&pair.t_s).iter().map(|t_s| t_s - onset_s).collect();
    // Where the plan stands when it starts.
    let base = t_s.iter().position(|t_s| *t_s >= 0.0).and_then(|i| planned.get(i)).copied().unwrap_or(0.0);
    let behind: Vec<f64> = planned.iter().zip(&measured).map(|(p, m)| sign * (p - m)).collect();
    let cut = |segment: &std::ops::Range<usize>| {
        let clip = |i: usize| i.clamp(from, to.max(from)) - from;
        let own = clip(segment.start)..clip(segment.end);
        (!own.is_empty()).then_some(own)
    };
    let segments: Vec<_> = pair.segments.iter().filter_map(cut).collect();
    let places = envelope(&segments, &[&planned, &measured, &behind], PLACES);
    let shown = |values: &[f64], base: f64, sign: f64| {
        at(values, &places)
            .map(|value| rounded(on_paper(pair.kind, sign * (value - base))))
            .collect::<Vec<f64>>()
    };
    let unit = unit(Dimension::Position, pair.kind);
    let series = |name: &str, role, y| Series::of(name, role, 0, y);
    let planned = series("planned", Role::Planned, shown(&planned, base, sign));
    let both = vec![planned, series("measured", Role::Measured, shown(&measured, base, sign))];
    let behind = vec![series("behind", Role::Error, shown(&behind, 0.0, 1.0))];
    let (kind, sign) = (transition.kind.name(), number(Dimension::Sign, pair.kind, sign));
    let late = transition.onset_delay_s.map_or_else(|| transition.answer.word().to_owned(), late);
    let waits =
        waits(transition, onset_s).map(|waits| Band { from: 0.0, to: rounded(waits.to - onset_s), ..waits });
    Chart {
        title: format!("{} {kind} {sign} at {onset_s:.2} s", transition.joint),
        note: format!("peak {}, {late}", position(pair.kind, transition.peak_error)),
        x_label: "Time from the planned start (s)".into(),
        xs: vec![times(&t_s, &places)],
        x_range: None,
        panels: vec![
            Panel::of(format!("Position ({unit})"), 0.5, both),
            Panel::of(format!("Behind ({unit})"), 0.5, behind),
        ],
        bands: waits.into_iter().collect(),
        group: None,
        height: 150,
        size: Size::Tile,
    }
}

/// From an instant of a start until the joint answers, or to the end of its window.
pub(super) fn waits(start: &Transition, from: f64) -> Option<Band> {
    let (to_s, shade) = match (start.answer, start.measured_onset_s) {
        (Answer::Never, _) => (start.window_s[1], Shade::Never),
        (_, onset_s) => (onset_s?, Shade::Late),
    };
    (to_s > from).then(|| Band { from, to: rounded(to_s), shade })
}
