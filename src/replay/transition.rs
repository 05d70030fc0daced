//! The metrics of one transition.

use super::{
    Answer, Kind, Rules, Transition,
    answer::untimed,
    delay::{Delay, delay},
    motion::Motion,
    onset::Onset,
    signals::Signals,
    tracking::{Sample, sample},
};
use crate::{math::median, series::Pair};

/// A delay whose interval is wider than this, s, and has both signs, is none.
const VAGUE_S: f64 = 2.5;

/// Measures the answer to a planned motion that starts at `asked`. `until_s` is where the window may not pass: the
/// next planned start or the end of the segment.
pub(super) fn transition(
    pair: &Pair,
    signals: &Signals,
    (planned, asked, until_s): (&Motion, Onset, f64),
    measured: Option<(&Motion, Onset)>,
    rules: &Rules,
) -> Transition {
    let Delay { method, planned_s, measured_s, interval_s } =
        delay(pair, signals, (planned, asked), measured, rules);
    let vague =
        interval_s.is_some_and(|[low_s, high_s]| high_s - low_s > VAGUE_S && low_s < 0.0 && high_s > 0.0);
    let (measured_s, interval_s) = if vague { (None, None) } else { (measured_s, interval_s) };
    let end_s = until_s.min(planned_s + rules.transition_window_s);
    let times = &pair.t_s[planned.segment.clone()];
    let first = planned.segment.start + times.partition_point(|&t| t < planned_s);
    // At the next start a plan that steps has its next value.
    let whole = times.last().is_none_or(|last_s| *last_s <= end_s);
    let end = planned.segment.start + times.partition_point(|&t| t < end_s || whole);
    // A motion has samples after its onset, so its window is never empty.
    let first = first.min(planned.segment.end - 1);
    let window = first..end.max(first + 1);
    let inside: Vec<Sample> = window.clone().map(|i| sample(pair, &planned.segment, i)).collect();

    let peak = inside
        .iter()
        .enumerate()
        .fold(0, |best, (k, s)| if s.error_rad.abs() > inside[best].error_rad.abs() { k } else { best });
    let peak_signed_rad = inside[peak].error_rad;
    let sign = if peak_signed_rad < 0.0 { -1.0 } else { 1.0 };
    let time_s: f64 = inside.iter().map(|s| s.weight_s).sum();
    let square: f64 = inside.iter().map(|s| s.weight_s * s.error_rad * s.error_rad).sum();
    let steps: Vec<f64> = inside.windows(2).map(|w| w[1].t_s - w[0].t_s).collect();
    let band_rad = signals.sizes.settle_band.max(rules.settle_sigmas * signals.noise.sigma);

    Transition {
        joint: pair.name.clone(),
        joint_kind: pair.kind,
        index: 0,
        id: format!("{}@{planned_s:.3}", pair.name),
        kind: if planned.reversal { Kind::Reversal } else { Kind::Start },
        direction: planned.direction,
        planned_onset_s: planned_s,
        answer: if measured_s.is_some() {
            Answer::Timed
        } else if vague {
            Answer::Unclear
        } else {
            let cut = window.end == planned.segment.end && end_s < planned_s + rules.transition_window_s;
            untimed(pair, signals, planned.direction, window, cut, rules)
        },
        measured_onset_s: measured_s,
        onset_method: method,
        onset_delay_s: measured_s.map(|at_s| at_s - planned_s),
        onset_delay_interval_s: interval_s,
        displacement_delay_s: displacement_delay_s(pair, signals, planned, (planned_s, end_s), rules),
        breakaway_error: measured_s
            .and_then(|at_s| error_at(pair, &planned.segment, at_s))
            .map(|e| f64::from(planned.direction) * e),
        jump: measured_s.and_then(|at_s| jump_rad_s(pair, signals, planned, at_s, rules)),
        peak_error: peak_signed_rad.abs(),
        peak_error_signed: peak_signed_rad,
        time_to_peak_s: inside[peak].t_s - planned_s,
        error_area: inside.iter().map(|s| s.weight_s * s.error_rad.abs()).sum(),
        rms_error: (square / time_s).sqrt(),
        overshoot: inside[peak..].iter().map(|s| -sign * s.error_rad).fold(0.0, f64::max),
        settling_time_s: settled_s(&inside, peak, band_rad, rules)
            .map(|at_s| at_s.max(planned_s) - planned_s),
        window_s: [planned_s, end_s],
        samples: inside.len(),
        time_resolution_s: if steps.is_empty() { signals.sample_interval_s } else { median(steps) }
            .max(pair.planned_interval_s),
    }
}

/// When the error enters the band for long enough after its peak, the earliest of all times if the peak lies in
/// the band; `None` if it does not before the window ends.
fn settled_s(inside: &[Sample], peak: usize, band_rad: f64, rules: &Rules) -> Option<f64> {
    if inside[peak].error_rad.abs() <= band_rad {
        return Some(f64::NEG_INFINITY);
    }
    let mut since_s = None;
    for sample in &inside[peak..] {
        if sample.error_rad.abs() > band_rad {
            since_s = None;
        } else if sample.t_s - *since_s.get_or_insert(sample.t_s) >= rules.settle_hold_s {
            return since_s;
        }
    }
    None
}

/// The error at a time in a segment, linear between samples, rad.
fn error_at(pair: &Pair, segment: &std::ops::Range<usize>, at_s: f64) -> Option<f64> {
    let above = segment.start + pair.t_s.get(segment.clone())?.partition_point(|&t_s| t_s <= at_s);
    let a = sample(pair, segment, above.checked_sub(1).filter(|i| segment.contains(i))?);
    if !segment.contains(&above) {
        return (a.t_s >= at_s).then_some(a.error_rad);
    }
    let b = sample(pair, segment, above);
    Some(a.error_rad + (at_s - a.t_s) / (b.t_s - a.t_s) * (b.error_rad - a.error_rad))
}

/// Largest excess of measured over planned speed, along the motion, soon after the onset.
fn jump_rad_s(pair: &Pair, signals: &Signals, planned: &Motion, onset_s: f64, rules: &Rules) -> Option<f64> {
    let times = &pair.t_s[planned.segment.clone()];
    let first = planned.segment.start + times.partition_point(|&t| t < onset_s);
    let end = planned.segment.start + times.partition_point(|&t| t <= onset_s + rules.jump_window_s);
    (first..end)
        .map(|i| f64::from(planned.direction) * (signals.measured_rad_s[i] - signals.planned_rad_s[i]))
        .reduce(f64::max)
}

/// Time between plan and joint having travelled the threshold from where each stood, or, in a
/// reversal, turned.
fn displacement_delay_s(
    pair: &Pair,
    signals: &Signals,
    planned: &Motion,
    (onset_s, end_s): (f64, f64),
    rules: &Rules,
) -> Option<f64> {
    let travel_rad = signals.sizes.displacement.max(rules.settle_sigmas * signals.noise.sigma);
    let times = &pair.t_s[planned.segment.clone()];
    let first = planned.segment.start + times.partition_point(|&t| t < onset_s);
    let end = planned.segment.start + times.partition_point(|&t| t <= end_s + rules.match_after_s);
    let rest_s = planned.rest_before_s.min(rules.min_rest_s);
    let rest = planned.segment.start + times.partition_point(|&t| t < onset_s - rest_s);
    let reached_s = |angle_rad: &[f64]| {
        let along = |i: usize| f64::from(planned.direction) * angle_rad[i];
        let at_rest = (!planned.reversal && rest < first).then(|| median((rest..first).map(along).collect()));
        let mut from = at_rest.unwrap_or(f64::INFINITY);
        let mut before: Option<usize> = None;
        for i in first..end {
            if at_rest.is_none() {
                from = from.min(along(i));
            }
            let over = along(i) - from - travel_rad;
            if over >= 0.0 {
                // Between the sample before and this one.
                let share = before.map_or(0.0, |k| over / (along(i) - along(k)).max(over));
                let step_s = before.map_or(0.0, |k| pair.t_s[i] - pair.t_s[k]);
                return Some(pair.t_s[i] - if share.is_finite() { share * step_s } else { 0.0 });
            }
            before = Some(i);
        }
        None
    };
    Some(reached_s(&pair.measured)? - reached_s(&pair.planned)?)
}
