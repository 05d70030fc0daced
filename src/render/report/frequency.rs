//! The error by frequency and by speed, and how each joint answers its plan by frequency.

use maud::{Markup, html};

use crate::{
    render::{
        kit::{
            clean,
            page::{
                Plots,
                chart::{Chart, Panel, Role, Series, Size, rounded},
            },
        },
        metric::{on_paper, position, unit},
    },
    replay::{COHERENT, Dimension, JointReplay, Response, Spectrum, spectrum, speeds},
    series::Pair,
    workflow::report::Report,
};

/// Points of speed and error at most, nearly.
const POINTS: usize = 700;

/// Plots by joint, the worst first and open; nothing where no run is long enough.
pub(super) fn frequency(report: &Report, plots: &mut Plots) -> Markup {
    let own = |name: &str| report.pairs.iter().find(|pair| pair.name == name);
    let worst_first = report.replay.joints_worst_first();
    let joints: Vec<_> = worst_first
        .into_iter()
        .filter_map(|joint| Some((joint, own(&joint.name)?)))
        .filter_map(|(joint, pair)| Some((joint, pair, spectrum(pair)?)))
        .collect();
    if joints.is_empty() {
        return html! { p class="hint" { "Nothing is told by frequency: that takes a stretch of 6 s without a gap." } };
    }
    html! {
        p class="hint" {
            "A peak of the error away from the slowest frequencies is a joint that swings. Over speed: a slope is lag, a step at zero a \
             dead band or friction. Gain and phase are told where the plan asks enough and coherence shows that the joint goes with it: \
             1 and 0 deg follow exactly."
        }
        @for (k, (joint, pair, found)) in joints.iter().enumerate() {
            details class="frequency" open[k == 0] {
                summary { b { (clean(&joint.name)) } " " (peak(pair, found)) }
                div class="side" {
                    @for chart in charts(report, joint, pair, found) { (if k == 0 { plots.place(chart) } else { plots.folded(chart) }) }
                }
            }
        }
    }
}

fn charts(report: &Report, joint: &JointReplay, pair: &Pair, found: &Spectrum) -> Vec<Chart> {
    let mut charts = vec![by_frequency(pair, found), by_speed(report, joint, pair)];
    charts.extend(found.response.as_ref().map(|told| answer(pair, found, told)));
    charts
}

/// Where the error is largest, in words.
fn peak(pair: &Pair, found: &Spectrum) -> String {
    if let Some([hz, error]) = found.swing() {
        return format!(
            "swings at {hz:.2} Hz, which the plan does not ask for: {}",
            position(pair.kind, error)
        );
    }
    let all = found.frequency_hz.iter().zip(&found.error);
    let largest = all.max_by(|a, b| a.1.total_cmp(b.1));
    largest.map_or(String::new(), |(hz, error)| {
        format!("error largest at {hz:.2} Hz: {}", position(pair.kind, *error))
    })
}

fn panel(label: String, series: Vec<Series>) -> Panel {
    Panel::of(label, 1.0, series)
}

fn titled(title: String, x_label: String, xs: Vec<Vec<f64>>, panels: Vec<Panel>) -> Chart {
    let size = Size::Half;
    Chart { title, x_label: x_label.into(), xs, panels, height: 240, size, ..Chart::default() }
}

fn by_frequency(pair: &Pair, found: &Spectrum) -> Chart {
    let shown = found.error.iter().map(|error| rounded(on_paper(pair.kind, *error)));
    let note = format!("{} windows of {:.1} s", found.windows, found.window_s);
    let hz = found.frequency_hz.iter().copied().map(rounded).collect();
    let series = vec![Series::of("amplitude of the error", Role::Error, 0, shown.collect())];
    let panel = panel(format!("Amplitude ({})", unit(Dimension::Position, pair.kind)), series);
    let chart =
        titled(format!("{}: error by frequency", pair.name), "Frequency (Hz)".into(), vec![hz], vec![panel]);
    Chart { note, ..chart }
}

fn by_speed(report: &Report, joint: &JointReplay, pair: &Pair) -> Chart {
    let [planned, _] = speeds(pair, joint.thresholds.window_s, &report.replay.rules);
    let every = pair.t_s.len().div_ceil(POINTS).max(1);
    let shown = |values: &mut dyn Iterator<Item = f64>| {
        values.step_by(every).map(|value| rounded(on_paper(pair.kind, value))).collect::<Vec<f64>>()
    };
    let error = shown(&mut pair.planned.iter().zip(&pair.measured).map(|(p, m)| p - m));
    let [speed_unit, unit] = [Dimension::Speed, Dimension::Position].map(|of| unit(of, pair.kind));
    titled(
        format!("{}: error by speed", pair.name),
        format!("Planned speed ({speed_unit})"),
        vec![shown(&mut planned.into_iter())],
        vec![panel(format!("Error ({unit})"), vec![Series::of("error", Role::Point, 0, error)])],
    )
}

fn answer(pair: &Pair, found: &Spectrum, told: &Response) -> Chart {
    let shown =
        |values: &[f64], scale: f64| values.iter().map(|value| rounded(scale * value)).collect::<Vec<_>>();
    let series = |name, role, values: &[f64], scale| vec![Series::of(name, role, 0, shown(values, scale))];
    // Gain and phase of what does not go with the plan mean nothing.
    let goes = |values: &[f64]| {
        let pairs = values.iter().zip(&told.coherence);
        pairs.map(|(value, share)| if *share < COHERENT { f64::NAN } else { *value }).collect::<Vec<f64>>()
    };
    let hz = shown(&found.frequency_hz[..told.gain.len().min(found.frequency_hz.len())], 1.0);
    let degrees = crate::units::degrees_from_radians(1.0);
    let chart = titled(
        format!("{}: measured by planned", pair.name),
        "Frequency (Hz)".into(),
        vec![hz],
        vec![
            panel("Gain".into(), series("gain", Role::Measured, &goes(&told.gain), 1.0)),
            panel("Phase (deg)".into(), series("phase", Role::Error, &goes(&told.phase_rad), degrees)),
            panel("Coherence".into(), series("coherence", Role::Before, &told.coherence, 1.0)),
        ],
    );
    Chart { note: format!("gain and phase where coherence is {COHERENT} or more"), height: 330, ..chart }
}
