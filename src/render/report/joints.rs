//! Joints over the whole run: planned, measured, error.

use std::collections::BTreeMap;

use maud::{Markup, html};

use super::{
    signals,
    tables::lag,
    tiles::waits,
    windows::{EACH, windows},
};
use crate::{
    render::{
        kit::{
            clean, ms,
            page::{
                Plots,
                chart::{Band, Chart, Panel, Role, Series, Shade, Size, at, rounded, times},
                envelope::with_parts,
                strip::{Row, intervals},
            },
        },
        metric::{on_paper, position, unit},
    },
    replay::{Dimension, JointReplay, Replay, Transition},
    series::Pair,
    workflow::report::Report,
};

/// Places of a series at most, nearly.
const MOST: usize = 3000;
pub(super) fn joints(report: &Report, plots: &mut Plots) -> Markup {
    let mut charts = joint_charts(report);
    for ((_, chart), pair) in charts.iter_mut().zip(&report.pairs) {
        signals::add(chart, report, pair);
    }
    html! {
        p class="hint" {
            "Drag to zoom, double-click for the whole run; all joints zoom together. Ctrl and wheel zoom, shift and wheel move; a \
             click sets a second cursor, from which differences count; a legend hides its line. Error is planned minus measured."
            @if report.pairs.iter().any(|pair| pair.t_s.len() > MOST) {
                " Of a long run samples are left out, those of peaks never: what lies between the points of a zoom, a report of that part \
                 shows (--from, --to)."
            }
        }
        p class="same-scale" { label { input type="checkbox"; " One scale for all joints" } }
        @for (joint, chart) in charts { div class="joint" data-name=(clean(&joint)) { (plots.place(chart)) } }
    }
}

pub(super) fn joint_charts(report: &Report) -> Vec<(String, Chart)> {
    let mut of: BTreeMap<&str, Vec<&Transition>> = BTreeMap::new();
    for transition in &report.replay.transitions {
        of.entry(&transition.joint).or_default().push(transition);
    }
    let chart = |pair: &Pair| {
        let transitions = of.get(pair.name.as_str()).map_or(&[][..], Vec::as_slice);
        (pair.name.clone(), joint_chart(pair, &report.replay, transitions))
    };
    report.pairs.iter().map(chart).collect()
}

fn joint_chart(pair: &Pair, replay: &Replay, transitions: &[&Transition]) -> Chart {
    let error: Vec<f64> = pair.planned.iter().zip(&pair.measured).map(|(p, m)| p - m).collect();
    let parts = windows(pair, replay);
    let places = with_parts(&pair.segments, &[&pair.planned, &pair.measured, &error], MOST, (&parts, EACH));
    let shown =
        |values: &[f64]| at(values, &places).map(|value| rounded(on_paper(pair.kind, value))).collect();
    let unit = unit(Dimension::Position, pair.kind);
    let series = |name: &str, role, y| Series::of(name, role, 0, y);
    let numbers = replay.joints.iter().find(|joint| joint.name == pair.name);
    let note = numbers.map_or(String::new(), |joint| {
        let late = joint.lag_s.map_or(String::new(), |s| format!(", lag {} ms", ms(s)));
        let error = &joint.tracking_error;
        format!("rms {}, peak {}{late}", position(pair.kind, error.rms), position(pair.kind, error.peak))
    });
    let note = note + &left_out(places.iter().flatten().count(), pair.t_s.len());
    let planned = series("planned", Role::Planned, shown(&pair.planned));
    let both = vec![planned, series("measured", Role::Measured, shown(&pair.measured))];
    Chart {
        title: pair.name.clone(),
        note,
        x_label: "Time (s)".into(),
        xs: vec![times(&pair.t_s, &places)],
        x_range: None,
        panels: vec![
            Panel::of(format!("Position ({unit})"), 0.6, both),
            Panel::of(format!("Error ({unit})"), 0.4, vec![series("error", Role::Error, shown(&error))]),
        ],
        bands: transitions.iter().flat_map(|transition| bands(transition)).collect(),
        group: Some("run"),
        height: 270,
        size: Size::Wide,
    }
}

/// What a plot that leaves samples out says of them.
fn left_out(drawn: usize, all: usize) -> String {
    let of = all as f64 / drawn.max(1) as f64;
    let said = || format!("; 1 of {of:.1} samples drawn, most at the worst starts");
    if drawn < all { said() } else { String::new() }
}

/// The window of a transition, and in it the time until the joint answers: all of it where it never does.
fn bands(transition: &Transition) -> Vec<Band> {
    let [from, to] = transition.window_s.map(rounded);
    let waits = waits(transition, from);
    std::iter::once(Band { from, to, shade: Shade::Window }).chain(waits).collect()
}

/// Joints with their lags, s.
pub(super) fn lag_rows(report: &Report) -> Vec<Row> {
    let row = |joint: &JointReplay| {
        let (name, text) = (joint.name.clone(), format!("{} ms", lag(joint)));
        Some(Row { name, value: joint.lag_s?, interval: joint.lag_interval_s, text, strong: false })
    };
    report.replay.joints.iter().filter_map(row).collect()
}

pub(super) fn lags(report: &Report) -> Markup {
    let rows = lag_rows(report);
    html! {
        @if rows.is_empty() {
            p { "No joint moves enough to tell its lag." }
        } @else {
            p { "Time by which the measured speed follows the planned one, with its 95 % interval over single motions." }
            (intervals(&rows))
        }
    }
}
