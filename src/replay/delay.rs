//! Planned and measured onset of one transition: when each speed first passed the same threshold.

use super::{
    OnsetMethod, Rules,
    motion::Motion,
    onset::{Onset, Search, onset},
    signals::Signals,
};
use crate::series::Pair;

/// Of the standard normal distribution, 97.5 %.
const NORMAL_975: f64 = 1.959_963_984_540_054;

/// The two onsets of a transition.
pub(super) struct Delay {
    pub(super) method: OnsetMethod,
    pub(super) planned_s: f64,
    pub(super) measured_s: Option<f64>,
    /// 95 % interval of the difference, widened by the time resolution, s.
    pub(super) interval_s: Option<[f64; 2]>,
}

/// Start of a measured motion; the crossing of the stop threshold where no better is known.
pub(super) fn measured_onset(pair: &Pair, signals: &Signals, motion: &Motion, rules: &Rules) -> Onset {
    let at_crossing = Onset { at_s: motion.start_s, interval_s: [motion.start_s; 2] };
    if motion.reversal {
        return at_crossing;
    }
    let search = Search {
        segment: motion.segment.clone(),
        direction: motion.direction,
        crossing_s: motion.start_s,
        rest_s: motion.rest_before_s,
        window_s: signals.thresholds.window_s,
    };
    onset_of(pair, &search, rules).unwrap_or(at_crossing)
}

/// When the speed of the plan passes the threshold.
///
/// Between a sample at rest and the first one above the threshold the plan is taken to
/// accelerate evenly, which its travel and its speed then date.
pub(super) fn planned_onset_s(pair: &Pair, signals: &Signals, motion: &Motion, rules: &Rules) -> f64 {
    let above =
        motion.samples.clone().find(|&i| along(motion, signals.planned_rad_s[i]) > rules.stop_floor_rad_s);
    let Some(above) = above.filter(|&i| i > motion.segment.start && !motion.reversal) else {
        return motion.start_s;
    };
    let (before_s, after_s) = (pair.t_s[above - 1], pair.t_s[above]);
    let speed_rad_s = along(motion, signals.planned_rad_s[above]);
    let travel_rad = along(motion, pair.planned_rad[above] - pair.planned_rad[above - 1]);
    if along(motion, signals.planned_rad_s[above - 1]).abs() > 0.1 * rules.stop_floor_rad_s
        || travel_rad <= 0.0
    {
        return motion.start_s;
    }
    let lasted_s = 2.0 * travel_rad / speed_rad_s;
    let passes_s = lasted_s * rules.stop_floor_rad_s / speed_rad_s;
    (after_s - lasted_s + passes_s).clamp(before_s, after_s)
}

fn along(motion: &Motion, value: f64) -> f64 {
    f64::from(motion.direction) * value
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
    let Some((motion, onset)) = measured else {
        return Delay { method: OnsetMethod::Fit, planned_s, measured_s: None, interval_s: None };
    };
    let blind_s = blind_s(pair, signals, planned);
    if motion.reversal {
        return reversal(pair, signals, planned, motion, blind_s);
    }
    let onset = unshaken(pair, signals, motion, onset, planned_s, rules).unwrap_or(onset);
    Delay {
        method: OnsetMethod::Fit,
        planned_s,
        measured_s: Some(onset.at_s),
        interval_s: Some([
            onset.interval_s[0].min(onset.at_s) - planned_s - blind_s,
            onset.interval_s[1].max(onset.at_s) - planned_s + blind_s,
        ]),
    }
}

/// A joint that is shaken by the others just before it is asked to move seems to answer early; its
/// onset is then looked for after the plan's. `None` if it was not early, or went a way before.
fn unshaken(
    pair: &Pair,
    signals: &Signals,
    motion: &Motion,
    onset: Onset,
    planned_s: f64,
    rules: &Rules,
) -> Option<Onset> {
    let times = &pair.t_s[motion.segment.clone()];
    let at = |t_s: f64| motion.segment.start + times.partition_point(|&t| t < t_s);
    let (from, asked) = (at(onset.at_s), at(planned_s));
    let early_rad = pair.measured_rad.get(asked)? - pair.measured_rad.get(from)?;
    if onset.interval_s[1] >= planned_s || early_rad.abs() >= rules.displacement_rad {
        return None;
    }
    let level_rad_s = signals.thresholds.measured_start_rad_s;
    let crossing =
        (asked..motion.samples.end).find(|&i| along(motion, signals.measured_rad_s[i]) > level_rad_s)?;
    let search = Search {
        segment: motion.segment.clone(),
        direction: motion.direction,
        crossing_s: pair.t_s[crossing],
        rest_s: pair.t_s[crossing] - planned_s + signals.thresholds.window_s,
        window_s: signals.thresholds.window_s,
    };
    onset_of(pair, &search, rules)
}

/// A joint that turns without resting: both speeds cross the measured stop threshold.
fn reversal(pair: &Pair, signals: &Signals, planned: &Motion, measured: &Motion, blind_s: f64) -> Delay {
    let level_rad_s = signals.thresholds.measured_stop_rad_s;
    let speeds = |motion: &Motion, of: &[f64]| {
        let first = motion.segment.start.max(motion.samples.start.saturating_sub(1));
        let speeds: Vec<f64> = (first..motion.samples.end).map(|i| along(motion, of[i])).collect();
        upward(&pair.t_s[first..motion.samples.end], &speeds, level_rad_s)
    };
    let (planned_s, _) = speeds(planned, &signals.planned_rad_s).unwrap_or((planned.start_s, 0.0));
    let (measured_s, slope) = speeds(measured, &signals.measured_rad_s).unwrap_or((measured.start_s, 0.0));
    // Noise of the speed over its slope is noise of the instant.
    let deviation_s = signals.deviation_rad_s[measured.samples.start] / slope;
    let half_s = blind_s + if deviation_s.is_finite() { NORMAL_975 * deviation_s } else { 0.0 };
    let delay_s = measured_s - planned_s;
    Delay {
        method: OnsetMethod::Crossing,
        planned_s,
        measured_s: Some(measured_s),
        interval_s: Some([delay_s - half_s, delay_s + half_s]),
    }
}

/// How long a motion cannot be seen for want of samples and encoder steps, s: a sample interval
/// and the time in which the plan travels half a step.
fn blind_s(pair: &Pair, signals: &Signals, planned: &Motion) -> f64 {
    let step_rad = 0.5 * signals.noise.lsb_rad.unwrap_or(0.0);
    let first = planned.samples.start;
    let travelled = |i: &usize| (pair.planned_rad[*i] - pair.planned_rad[first]).abs() >= step_rad;
    let seen = planned.samples.clone().find(travelled).unwrap_or(first);
    signals.sample_interval_s + pair.t_s[seen] - pair.t_s[first]
}

/// The first upward crossing of `level`: when, s, and the slope there, rad/s².
fn upward(t_s: &[f64], speed_rad_s: &[f64], level_rad_s: f64) -> Option<(f64, f64)> {
    let i = (1..speed_rad_s.len())
        .find(|&i| speed_rad_s[i - 1] <= level_rad_s && speed_rad_s[i] > level_rad_s)?;
    let slope = (speed_rad_s[i] - speed_rad_s[i - 1]) / (t_s[i] - t_s[i - 1]);
    Some((t_s[i - 1] + (level_rad_s - speed_rad_s[i - 1]) / slope, slope))
}

fn onset_of(pair: &Pair, search: &Search, rules: &Rules) -> Option<Onset> {
    onset(&pair.t_s, &pair.measured_rad, search, rules)
}
