//! What else was logged of a joint, under its plot on the same times: speeds, command, valve, pressures.

use super::windows::{EACH, windows};
use crate::{
    log::SignalRole,
    render::{
        kit::page::{
            chart::{Chart, Panel, Role, Series, at, hundredths, rounded, times},
            envelope::{envelope, with_parts},
        },
        metric::{on_paper, unit},
    },
    replay::{Dimension, speeds},
    series::Pair,
    workflow::report::Report,
};

/// Places of a series at most, nearly.
const MOST: usize = 1200;
/// Height of a panel, pixels, and its share beside those of position and error, which have one together.
const HEIGHT: u32 = 90;
const SHARE: f64 = 0.33;
/// A share of a valve's full signal in percent; pascals in bar.
const PERCENT: f64 = 100.0;
const BAR_PA: f64 = 1e5;

/// Adds what the report holds of the joint to its plot.
pub(super) fn add(chart: &mut Chart, report: &Report, pair: &Pair) {
    if let Some(series) = command(chart, report, pair) {
        // Below what was measured.
        let panel = &mut chart.panels[0].series;
        panel.insert(panel.len().min(1), series);
    }
    let speed = speed(chart, report, pair, View::ALL, SHARE);
    let valve = [(SignalRole::Valve, "valve", Role::Measured)];
    let pressures = [
        (SignalRole::CapPressure, "piston side", Role::Measured),
        (SignalRole::RodPressure, "rod side", Role::Error),
        (SignalRole::SupplyPressure, "supply", Role::Before),
    ];
    let logged = [("Valve (%)", &valve[..], PERCENT), ("Pressure (bar)", &pressures, 1.0 / BAR_PA)];
    let logged = logged.map(|(label, roles, scale)| panel(label, signals(chart, report, pair, roles, scale)));
    for panel in std::iter::once(speed).chain(logged).flatten() {
        chart.panels.push(panel);
        chart.height += HEIGHT;
    }
}

fn panel(label: &str, series: Vec<Series>) -> Option<Panel> {
    (!series.is_empty()).then(|| Panel::of(label, SHARE, series))
}

/// Puts coordinates into the chart, unless it has them, and gives their index.
fn coordinates(chart: &mut Chart, t_s: &[f64], places: &[Option<usize>]) -> usize {
    let xs = times(t_s, places);
    chart.xs.iter().position(|held| *held == xs).unwrap_or_else(|| {
        chart.xs.push(xs);
        chart.xs.len() - 1
    })
}

fn series(name: &str, role: Role, x: usize, y: impl Iterator<Item = f64>) -> Series {
    Series::of(name, role, x, y.map(rounded).collect())
}

/// What was sent, where it is not the plan itself.
fn command(chart: &mut Chart, report: &Report, pair: &Pair) -> Option<Series> {
    let track = report.command.as_ref()?.series.track(&pair.name)?;
    let places = envelope(track.segments(), &[track.position()], MOST);
    let x = coordinates(chart, track.t_s(), &places);
    let sent = at(track.position(), &places).map(|value| on_paper(pair.kind, value));
    Some(series("command", Role::Command, x, sent))
}

/// What of a joint's samples is drawn: times from an instant on, in the direction of a motion.
#[derive(Clone, Copy)]
pub(super) struct View {
    pub(super) zero_s: f64,
    pub(super) shown_s: [f64; 2],
    pub(super) sign: f64,
}

impl View {
    const ALL: Self = Self { zero_s: 0.0, shown_s: [f64::NEG_INFINITY, f64::INFINITY], sign: 1.0 };
}

/// The planned and the measured speed of a joint.
pub(super) fn speed(
    chart: &mut Chart,
    report: &Report,
    pair: &Pair,
    view: View,
    share: f64,
) -> Option<Panel> {
    let replay = &report.replay;
    let window_s = replay.joints.iter().find(|joint| joint.name == pair.name)?.thresholds.window_s;
    let [planned, measured] = speeds(pair, window_s, &replay.rules);
    let t_s: Vec<f64> = pair.t_s.iter().map(|t_s| t_s - view.zero_s).collect();
    let [from, to] = view.shown_s.map(|shown_s| t_s.partition_point(|t_s| *t_s < shown_s));
    let within = |part: &std::ops::Range<usize>| part.start.max(from)..part.end.min(to);
    let parts: Vec<_> = pair.segments.iter().map(within).filter(|part| !part.is_empty()).collect();
    let whole = from == 0 && to == t_s.len();
    let windows = if whole { windows(pair, replay) } else { Vec::new() };
    let places = with_parts(&parts, &[&planned, &measured], MOST, (&windows, EACH));
    let x = coordinates(chart, &t_s, &places);
    let shown = |values| at(values, &places).map(|value| hundredths(on_paper(pair.kind, view.sign * value)));
    let series = vec![
        series("planned speed", Role::Planned, x, shown(&planned)),
        series("measured speed", Role::Measured, x, shown(&measured)),
    ];
    Some(Panel::of(format!("Speed ({})", unit(Dimension::Speed, pair.kind)), share, series))
}

/// Those signals of a joint that the report holds, with what they are called and look like.
fn signals(
    chart: &mut Chart,
    report: &Report,
    pair: &Pair,
    roles: &[(SignalRole, &str, Role)],
    scale: f64,
) -> Vec<Series> {
    let mut found = Vec::new();
    for (role, name, look) in roles {
        let all = report.signals.get(role).map_or(&[][..], Vec::as_slice);
        let Some(signal) = all.iter().find(|signal| signal.name() == pair.name) else { continue };
        let places = envelope(signal.segments(), &[signal.values()], MOST);
        let x = coordinates(chart, signal.t_s(), &places);
        let values = at(signal.values(), &places).map(|value| hundredths(scale * value));
        found.push(series(name, *look, x, values));
    }
    found
}
