//! Planned and measured onset of one transition, found alike on both sides.

use super::{
    OnsetMethod, Rules,
    motion::Motion,
    onset::{MEASURED_RISES, Onset, PLANNED_RISES, onset},
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
    /// 95 % interval of the difference, widened by the time resolution, s.
    pub(super) interval_s: Option<[f64; 2]>,
}

/// Start of a measured motion; the crossing of the stop threshold where no better is known.
pub(super) fn measured_onset(pair: &Pair, signals: &Signals, motion: &Motion, rules: &Rules) -> Onset {
    let at_crossing = Onset { at_s: motion.start_s, interval_s: [motion.start_s; 2] };
    if motion.reversal {
        return at_crossing;
    }
    let shape = (motion.start_s, motion.rest_before_s, signals.thresholds.window_s);
    onset(&pair.t_s, &pair.measured_rad, &motion.segment, motion.direction, shape, MEASURED_RISES, rules)
        .unwrap_or(at_crossing)
}

/// When the plan starts: where a steep one leaves rest, found as for the measurement, or where a
/// gentle one crosses the stop threshold.
pub(super) fn planned_onset_s(pair: &Pair, signals: &Signals, motion: &Motion, rules: &Rules) -> f64 {
    if motion.reversal || !is_steep(pair, signals, motion, rules) {
        return motion.start_s;
    }
    let plan = SmoothPlan::around(pair, signals, motion, rules);
    let level = signals.thresholds.measured_stop_rad_s;
    let Some((crossing_s, _)) = upward(plan.t_s, &plan.along_rad_s, level, motion.start_s) else {
        return motion.start_s;
    };
    let shape = (crossing_s, motion.rest_before_s, signals.thresholds.window_s);
    let found =
        onset(&pair.t_s, &pair.planned_rad, &motion.segment, motion.direction, shape, PLANNED_RISES, rules);
    found.map_or(motion.start_s, |onset| onset.at_s)
}

/// Delay of one transition, whose plan starts at `planned_s`.
pub(super) fn delay(
    pair: &Pair,
    signals: &Signals,
    (planned, planned_s): (&Motion, f64),
    measured: Option<(&Motion, Onset)>,
    rules: &Rules,
) -> Delay {
    let steep = !planned.reversal && is_steep(pair, signals, planned, rules);
    let method = if steep { OnsetMethod::Departure } else { OnsetMethod::Crossing };
    let Some((motion, onset)) = measured else {
        return Delay { method, planned_s, measured_s: None, interval_s: None };
    };
    if (!steep || motion.reversal)
        && let Some(delay) = crossing_delay(pair, signals, planned, motion, rules)
    {
        return delay;
    }
    let blind_s = blind_s(pair, signals, planned);
    Delay {
        method: OnsetMethod::Departure,
        planned_s,
        measured_s: Some(onset.at_s),
        interval_s: Some([
            onset.interval_s[0].min(onset.at_s) - planned_s - blind_s,
            onset.interval_s[1].max(onset.at_s) - planned_s + blind_s,
        ]),
    }
}

/// Whether the plan is well above the measured start threshold before smoothing could blur it.
fn is_steep(pair: &Pair, signals: &Signals, motion: &Motion, rules: &Rules) -> bool {
    let enough_rad_s = rules.steep_ratio * signals.thresholds.measured_start_rad_s;
    let soon_s = motion.start_s + signals.thresholds.window_s;
    let mut soon = motion.samples.clone().take_while(|&i| pair.t_s[i] <= soon_s);
    soon.any(|i| signals.planned_rad_s[i].abs() >= enough_rad_s)
}

/// The plan around the start of a motion, smoothed as the measurement is.
struct SmoothPlan<'a> {
    t_s: &'a [f64],
    /// Speed along the motion, rad/s.
    along_rad_s: Vec<f64>,
}

impl<'a> SmoothPlan<'a> {
    fn around(pair: &'a Pair, signals: &Signals, motion: &Motion, rules: &Rules) -> Self {
        let window_s = signals.thresholds.window_s;
        let reach_s = 3.0 * window_s + rules.min_rest_s;
        let times = &pair.t_s[motion.segment.clone()];
        let first = motion.segment.start + times.partition_point(|&t| t < motion.start_s - reach_s);
        let until_s = motion.end_s.min(motion.start_s + 2.0) + 2.0 * window_s;
        let end = motion.segment.start + times.partition_point(|&t| t <= until_s);
        let t_s = &pair.t_s[first..end];
        let whole = 0..t_s.len();
        let fits = local_quadratic(
            t_s,
            &pair.planned_rad[first..end],
            std::slice::from_ref(&whole),
            window_s,
            rules.window_points,
        );
        let along_rad_s = fits.iter().map(|fit| f64::from(motion.direction) * fit.velocity_rad_s).collect();
        Self { t_s, along_rad_s }
    }
}

/// Both speeds, equally smoothed, cross the same two thresholds; `None` where one does not.
fn crossing_delay(
    pair: &Pair,
    signals: &Signals,
    planned: &Motion,
    measured: &Motion,
    rules: &Rules,
) -> Option<Delay> {
    let plan = SmoothPlan::around(pair, signals, planned, rules);
    let first = measured.segment.start.max(measured.samples.start.saturating_sub(1));
    let end = measured.segment.end.min(measured.samples.end + 1);
    let along: Vec<f64> =
        (first..end).map(|i| f64::from(measured.direction) * signals.measured_rad_s[i]).collect();

    let plan_s = |level| Some(upward(plan.t_s, &plan.along_rad_s, level, planned.start_s)?.0);
    let joint_s = |level| upward(&pair.t_s[first..end], &along, level, measured.start_s);
    let (stop, start) = (signals.thresholds.measured_stop_rad_s, signals.thresholds.measured_start_rad_s);
    let planned_s = 0.5 * (plan_s(stop)? + plan_s(start)?);
    let ((low_s, low), (high_s, _)) = (joint_s(stop)?, joint_s(start)?);
    let measured_s = 0.5 * (low_s + high_s);
    // Noise of the speed over its slope between the two thresholds is noise of the instant.
    let climb_s = (high_s - low_s).max(0.0);
    let deviation_s = signals.deviation_rad_s[first + low] * climb_s / (start - stop).max(f64::MIN_POSITIVE);
    let delay_s = measured_s - planned_s;
    let half_s = NORMAL_975 * deviation_s + blind_s(pair, signals, planned);
    Some(Delay {
        method: OnsetMethod::Crossing,
        planned_s,
        measured_s: Some(measured_s),
        interval_s: Some([delay_s - half_s, delay_s + half_s]),
    })
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

/// The upward crossing of `level` nearest to a time: when, s, and the sample above.
fn upward(t_s: &[f64], speed: &[f64], level: f64, near_s: f64) -> Option<(f64, usize)> {
    (1..speed.len())
        .filter(|&i| speed[i - 1] <= level && speed[i] > level)
        .map(|i| {
            let share = (level - speed[i - 1]) / (speed[i] - speed[i - 1]);
            (t_s[i - 1] + share * (t_s[i] - t_s[i - 1]), i)
        })
        .min_by(|a, b| (a.0 - near_s).abs().total_cmp(&(b.0 - near_s).abs()))
}
