//! Planned and measured onset of one transition, found alike on both sides.

use super::{
    OnsetMethod, Rules,
    motion::Motion,
    onset::{Onset, onset},
    signals::Signals,
};
use crate::series::{Pair, local_quadratic};

/// Of the standard normal distribution, 97.5 %.
const NORMAL_975: f64 = 1.959_963_984_540_054;

/// The two onsets of a transition.
pub(super) struct Delay {
    pub(super) method: OnsetMethod,
    pub(super) planned_s: f64,
    pub(super) measured_s: Option<f64>,
    /// 95 % interval of the difference, widened by one sample interval, s.
    pub(super) interval_s: Option<[f64; 2]>,
}

/// Start of a measured motion; the crossing of the stop threshold where no better is known.
pub(super) fn measured_onset(pair: &Pair, signals: &Signals, motion: &Motion, rules: &Rules) -> Onset {
    let at_crossing = Onset { at_s: motion.start_s, interval_s: [motion.start_s; 2] };
    if motion.reversal {
        return at_crossing;
    }
    let shape = (motion.start_s, motion.rest_before_s, signals.thresholds.window_s);
    onset(&pair.t_s, &pair.measured_rad, &motion.segment, motion.direction, shape, rules)
        .unwrap_or(at_crossing)
}

/// Where the plan leaves rest: sub-sample where its angle tells.
pub(super) fn planned_onset_s(pair: &Pair, signals: &Signals, motion: &Motion, rules: &Rules) -> f64 {
    if motion.reversal || !is_sharp(pair, signals, motion, rules) {
        return motion.start_s;
    }
    let reach_s = 2.0 * signals.sample_interval_s;
    let shape = (motion.start_s, motion.rest_before_s.min(rules.sharp_rise_s), reach_s);
    let found = onset(&pair.t_s, &pair.planned_rad, &motion.segment, motion.direction, shape, rules);
    found.map_or(motion.start_s, |onset| onset.at_s)
}

/// Delay of one transition.
pub(super) fn delay(
    pair: &Pair,
    signals: &Signals,
    planned: &Motion,
    measured: Option<(&Motion, Onset)>,
    rules: &Rules,
) -> Delay {
    let planned_s = planned_onset_s(pair, signals, planned, rules);
    let sharp = !planned.reversal && is_sharp(pair, signals, planned, rules);
    let method = if sharp { OnsetMethod::Departure } else { OnsetMethod::Crossing };
    let Some((motion, onset)) = measured else {
        return Delay { method, planned_s, measured_s: None, interval_s: None };
    };
    if !sharp && let Some(delay) = crossing_delay(pair, signals, planned, motion, rules) {
        return delay;
    }
    let dt_s = signals.sample_interval_s;
    Delay {
        method: OnsetMethod::Departure,
        planned_s,
        measured_s: Some(onset.at_s),
        interval_s: Some([
            onset.interval_s[0].min(onset.at_s) - planned_s - dt_s,
            onset.interval_s[1].max(onset.at_s) - planned_s + dt_s,
        ]),
    }
}

/// Whether the plan soon reaches half of its speed.
fn is_sharp(pair: &Pair, signals: &Signals, motion: &Motion, rules: &Rules) -> bool {
    let soon = motion.samples.clone().take_while(|&i| pair.t_s[i] - motion.start_s <= 1.0);
    let peak_rad_s = soon.clone().map(|i| signals.planned_rad_s[i].abs()).fold(0.0, f64::max);
    let half = soon.clone().find(|&i| signals.planned_rad_s[i].abs() >= 0.5 * peak_rad_s);
    half.is_some_and(|i| pair.t_s[i] - motion.start_s <= rules.sharp_rise_s)
}

/// Both speeds, equally smoothed, cross the same two thresholds; `None` where one does not.
fn crossing_delay(
    pair: &Pair,
    signals: &Signals,
    planned: &Motion,
    measured: &Motion,
    rules: &Rules,
) -> Option<Delay> {
    let window_s = signals.thresholds.window_s;
    let times = &pair.t_s[planned.segment.clone()];
    let first = times.partition_point(|&t| t < planned.start_s - 3.0 * window_s - rules.min_rest_s);
    let end = times.partition_point(|&t| t <= planned.end_s.min(planned.start_s + 2.0) + 2.0 * window_s);
    let (first, end) = (planned.segment.start + first, planned.segment.start + end);
    let (t_s, angle_rad) = (&pair.t_s[first..end], &pair.planned_rad[first..end]);
    let smooth: Vec<f64> =
        local_quadratic(t_s, angle_rad, std::slice::from_ref(&(0..t_s.len())), window_s, rules.window_points)
            .iter()
            .map(|fit| f64::from(planned.direction) * fit.velocity_rad_s)
            .collect();

    let reach = measured.segment.end.min(measured.samples.end + 1);
    let base = measured.segment.start;
    let along: Vec<f64> = (base.max(measured.samples.start.saturating_sub(1))..reach)
        .map(|i| f64::from(measured.direction) * signals.measured_rad_s[i])
        .collect();
    let offset = base.max(measured.samples.start.saturating_sub(1));

    let (mut planned_s, mut measured_s, mut deviation_s) = (0.0, 0.0, 0.0);
    let levels = [signals.thresholds.measured_stop_rad_s, signals.thresholds.measured_start_rad_s];
    for level in levels {
        planned_s += 0.5 * upward(t_s, &smooth, level, planned.start_s)?.0;
        let (at_s, slope, i) = upward(&pair.t_s[offset..reach], &along, level, measured.start_s)?;
        measured_s += 0.5 * at_s;
        deviation_s += 0.5 * signals.deviation_rad_s[offset + i] / slope;
    }
    let (half_s, delay_s) = (NORMAL_975 * deviation_s + signals.sample_interval_s, measured_s - planned_s);
    Some(Delay {
        method: OnsetMethod::Crossing,
        planned_s,
        measured_s: Some(measured_s),
        interval_s: Some([delay_s - half_s, delay_s + half_s]),
    })
}

/// The upward crossing of `level` nearest to a time: when s, slope there, sample above.
fn upward(t_s: &[f64], speed: &[f64], level: f64, near_s: f64) -> Option<(f64, f64, usize)> {
    (1..speed.len())
        .filter(|&i| speed[i - 1] <= level && speed[i] > level)
        .map(|i| {
            let slope = (speed[i] - speed[i - 1]) / (t_s[i] - t_s[i - 1]);
            (t_s[i - 1] + (level - speed[i - 1]) / slope, slope, i)
        })
        .min_by(|a, b| (a.0 - near_s).abs().total_cmp(&(b.0 - near_s).abs()))
}
