//! Planned and measured onset of one transition: when each speed first passed the same threshold.

use super::{
    OnsetMethod, Rules,
    motion::Motion,
    onset::{Onset, Search, onset},
    signals::Signals,
    stairs,
};
use crate::series::{Pair, local_quadratic};

/// Of the standard normal distribution, 97.5 %.
const NORMAL_975: f64 = 1.959_963_984_540_054;

/// A joint that turns three times within this time before a start swings, s.
const SWINGS_S: f64 = 3.0;
/// One that has rested so long has settled, s.
const SETTLED_S: f64 = 0.25;

/// What the shapes that departures are tried with miss of others, however fast the samples come, s.
const SHAPE_S: f64 = 0.008;

/// A joint that was shaken slows down to this share of its speed before it leaves.
const SHAKEN: f64 = 0.5;

/// The two onsets of a transition.
pub(super) struct Delay {
    pub(super) method: OnsetMethod,
    pub(super) planned_s: f64,
    pub(super) measured_s: Option<f64>,
    /// 95 % interval of the difference, widened by the time resolution, s.
    pub(super) interval_s: Option<[f64; 2]>,
}

/// Directions and onsets, s, of all measured starts, reversals included: whether a plan asks for them or
/// not.
pub fn measured_starts(pair: &Pair, rules: &Rules) -> Vec<(i8, f64)> {
    let signals = Signals::new(pair, rules);
    let seen = signals.measured.iter().filter(|m| m.starts());
    seen.map(|m| (m.direction, measured_onset(pair, &signals, m, rules).at_s)).collect()
}

/// Directions and ends, s, of all measured motions that end at rest.
pub fn measured_stops(pair: &Pair, rules: &Rules) -> Vec<(i8, f64)> {
    let signals = Signals::new(pair, rules);
    signals.measured.iter().filter(|m| m.stops()).map(|m| (m.direction, m.end_s)).collect()
}

/// Start of a measured motion; the crossing of the stop threshold where no better is known.
pub(super) fn measured_onset(pair: &Pair, signals: &Signals, motion: &Motion, rules: &Rules) -> Onset {
    let crossing_s = motion.start_s;
    let window_s = reach_s(pair, signals, motion, (motion.samples.start, crossing_s), rules);
    // A smoothed speed shows a start up to half a window early.
    let at_crossing = Onset { at_s: crossing_s, interval_s: [crossing_s, crossing_s + window_s] };
    if motion.reversal {
        return at_crossing;
    }
    let found = onset_of(pair, &search(signals, motion, window_s), rules).unwrap_or(at_crossing);
    let band_s =
        stairs::within_band(&pair.t_s, &pair.measured, motion).filter(|_| signals.noise.lsb.is_none());
    let Some([earliest_s, shows_s]) = band_s else { return found };
    let [low_s, high_s] = found.interval_s;
    Onset { at_s: found.at_s.min(shows_s), interval_s: [low_s.min(earliest_s), high_s.max(shows_s)] }
}

/// Where the onset of a motion is looked for: about where it passes the stop threshold.
fn search(signals: &Signals, motion: &Motion, window_s: f64) -> Search {
    Search {
        segment: motion.segment.clone(),
        direction: motion.direction,
        crossing_s: motion.start_s,
        rest_s: motion.rest_before_s,
        window_s,
        stop_speed: signals.sizes.stop_speed,
        sticks: true,
    }
}

/// When the speed of the plan passes the threshold, and how well that is known.
pub(super) fn planned_onset(pair: &Pair, signals: &Signals, motion: &Motion, rules: &Rules) -> Onset {
    let blurred = !motion.reversal && motion.step(&pair.planned).is_none();
    let rounded = || stairs::onset(pair, motion, signals.planned_step?, signals.sizes.stop_speed, rules);
    let noisy = || {
        let search = Search { sticks: false, ..search(signals, motion, signals.noisy_plan_s?) };
        onset(&pair.t_s, &pair.planned, &search, rules)
    };
    let late = || {
        let smooth = pair.planned_step.is_none() && pair.planned_velocity.is_none();
        let interval_s = stairs::within_band(&pair.t_s, &pair.planned, motion).filter(|_| smooth)?;
        Some(Onset { at_s: interval_s[1], interval_s })
    };
    let found = if blurred { rounded().or_else(noisy).or_else(late) } else { None };
    found.unwrap_or_else(|| {
        let at_s = planned_onset_s(pair, signals, motion);
        Onset { at_s, interval_s: [at_s, at_s] }
    })
}

/// When the speed of a plan that is not rounded passes the threshold.
///
/// Between a sample at rest and the first one above the threshold the plan is taken to
/// accelerate evenly, which its travel and its speed then date.
pub(super) fn planned_onset_s(pair: &Pair, signals: &Signals, motion: &Motion) -> f64 {
    if motion.reversal {
        return motion.start_s;
    }
    let (t_s, angle_rad) = (&pair.t_s, &pair.planned);
    // A set value that steps holds until it does: nothing is asked for between the two samples.
    if let Some(at) = motion.step(angle_rad) {
        return t_s[at];
    }
    let last = motion.segment.end - 1;
    // A plan without speeds is not smoothed here: that would blur its start.
    let speed_rad_s = |i: usize| match &pair.planned_velocity {
        Some(given) => along(motion, given[i]),
        None if i < last => along(motion, angle_rad[i + 1] - angle_rad[i]) / (t_s[i + 1] - t_s[i]),
        None => along(motion, signals.planned_rad_s[i]),
    };
    let faster = |i: usize| speed_rad_s(i) > signals.sizes.stop_speed;
    let Some(mut above) = motion.samples.clone().find(|&i| faster(i)) else { return motion.start_s };
    while above > motion.segment.start && faster(above - 1) {
        above -= 1;
    }
    if above == motion.segment.start {
        return motion.start_s;
    }
    let at_speed_rad_s = speed_rad_s(above);
    let travel_rad = along(motion, angle_rad[above] - angle_rad[above - 1]).max(0.0);
    let lasted_s = 2.0 * travel_rad / at_speed_rad_s;
    let passes_s = lasted_s * signals.sizes.stop_speed / at_speed_rad_s;
    (t_s[above] - lasted_s + passes_s).clamp(t_s[above - 1], t_s[above])
}

fn along(motion: &Motion, value: f64) -> f64 {
    f64::from(motion.direction) * value
}

/// A joint that covers this share of the planned travel did not rest.
const WENT_ALONG: f64 = 0.4;
/// A joint that turns before its plan leaves rest by more than this, s, its whole interval, swings back; less is a lead.
const SURELY_EARLY_S: f64 = 0.15;
/// That is asked of a joint whose whole interval is later than this, s.
const SURELY_LATE_S: f64 = 0.1;

/// Delay of one transition.
pub(super) fn delay(
    pair: &Pair,
    signals: &Signals,
    (planned, asked): (&Motion, Onset),
    measured: Option<(&Motion, Onset)>,
    rules: &Rules,
) -> Delay {
    let planned_s = asked.at_s;
    let Some((motion, onset)) = measured else {
        return Delay { method: OnsetMethod::Fit, planned_s, measured_s: None, interval_s: None };
    };
    let blind_s = blind_s(pair, signals, (planned, planned_s), (motion, onset.at_s));
    if swings(signals, (planned, planned_s), motion) {
        return Delay { method: OnsetMethod::Fit, planned_s, measured_s: None, interval_s: None };
    }
    if motion.reversal {
        let found = reversal(pair, signals, (planned, planned_s), motion, blind_s, rules);
        // One that surely turns before its plan leaves rest swings back from its last motion.
        let swung =
            !planned.reversal && found.interval_s.is_some_and(|[_, latest_s]| latest_s < -SURELY_EARLY_S);
        return if swung { Delay { measured_s: None, interval_s: None, ..found } } else { found };
    }
    let (early_s, late_s) = (planned_s - asked.interval_s[0], asked.interval_s[1] - planned_s);
    let onset = unshaken(pair, signals, motion, onset, planned_s, rules).unwrap_or(onset);
    let surely_late = onset.interval_s[0] - blind_s - planned_s > SURELY_LATE_S;
    if surely_late && went_along(pair, signals, (planned, planned_s), onset.at_s) {
        return Delay { method: OnsetMethod::Fit, planned_s, measured_s: None, interval_s: None };
    }
    Delay {
        method: OnsetMethod::Fit,
        planned_s,
        measured_s: Some(onset.at_s),
        interval_s: Some([
            onset.at_s - planned_s - (onset.at_s - onset.interval_s[0]).max(0.0).hypot(late_s) - blind_s,
            onset.at_s - planned_s + (onset.interval_s[1] - onset.at_s).max(0.0).hypot(early_s) + blind_s,
        ]),
    }
}

/// Whether the joint went to and fro while its plan rested before a start, as one that hunts does: which of its motions is
/// the answer cannot be told. A joint that settled from its last motion and rested has an answer.
fn swings(signals: &Signals, (planned, planned_s): (&Motion, f64), answer: &Motion) -> bool {
    if !answer.reversal && answer.rest_before_s >= SETTLED_S {
        return false;
    }
    let from_s = planned_s - planned.rest_before_s.min(SWINGS_S);
    let before = signals.measured.iter().filter(|motion| motion.segment == planned.segment);
    let before = before.filter(|motion| motion.start_s > from_s && motion.start_s < planned_s);
    let directions: Vec<i8> = before.map(|motion| motion.direction).collect();
    directions.windows(2).filter(|two| two[0] != two[1]).count() >= 2
}

/// Whether a joint went along with its plan before it is found to leave: of a motion that grows slower than noise lets see, the
/// instant is not known.
fn went_along(pair: &Pair, signals: &Signals, (planned, planned_s): (&Motion, f64), leaves_s: f64) -> bool {
    let times = &pair.t_s[planned.segment.clone()];
    let at = |t_s: f64| planned.segment.start + times.partition_point(|&t| t < t_s);
    // Smoothing brings the motion itself forward.
    let last = planned.segment.end - 1;
    let (from, to) = (at(planned_s), at(leaves_s - signals.thresholds.window_s).min(last));
    if from >= to {
        return false;
    }
    let went = |position: &[f64]| along(planned, position[to] - position[from]);
    let came = went(&signals.measured_rad);
    came >= WENT_ALONG * went(&pair.planned) && came >= signals.min_travel
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
    let early_rad = pair.measured.get(asked)? - pair.measured.get(from)?;
    if onset.interval_s[1] >= planned_s || early_rad.abs() >= signals.sizes.displacement {
        return None;
    }
    let level_rad_s = signals.thresholds.measured_start;
    let crossing =
        (asked..motion.samples.end).find(|&i| along(motion, signals.measured_rad_s[i]) > level_rad_s)?;
    // What was shaken comes to rest before it leaves, or nearly; what leads its plan goes on.
    let mut fastest = 0.0_f64;
    let slows = |i: usize| {
        let speed = along(motion, signals.measured_rad_s[i]);
        fastest = fastest.max(speed);
        speed < SHAKEN * fastest && fastest - speed > 2.0 * signals.deviation_rad_s[i]
    };
    if !(from..crossing).any(slows) {
        return None;
    }
    let crossing_s = pair.t_s[crossing];
    let window_s = reach_s(pair, signals, motion, (crossing, crossing_s), rules);
    let search = Search {
        segment: motion.segment.clone(),
        direction: motion.direction,
        crossing_s,
        rest_s: crossing_s - planned_s + window_s,
        window_s,
        stop_speed: signals.sizes.stop_speed,
        sticks: true,
    };
    onset_of(pair, &search, rules)
}

/// A joint that turns without resting: the plan is smoothed as the measurement is, and both speeds
/// cross the measured stop and start thresholds.
fn reversal(
    pair: &Pair,
    signals: &Signals,
    (planned, asked_s): (&Motion, f64),
    measured: &Motion,
    blind_s: f64,
    rules: &Rules,
) -> Delay {
    let (stop, start) = (signals.thresholds.measured_stop, signals.thresholds.measured_start);
    let first = measured.segment.start.max(measured.samples.start.saturating_sub(1));
    let times = &pair.t_s[first..measured.samples.end];
    let speeds: Vec<f64> =
        (first..measured.samples.end).map(|i| along(measured, signals.measured_rad_s[i])).collect();
    let (plan_s, plan) = smoothed_plan(pair, signals, planned, rules);
    let crossings = || {
        let planned_s =
            0.5 * (upward(plan_s, &plan, stop, asked_s)? + upward(plan_s, &plan, start, asked_s)?);
        let low_s = upward(times, &speeds, stop, measured.start_s)?;
        Some((planned_s, low_s, upward(times, &speeds, start, measured.start_s)?))
    };
    let crossing = OnsetMethod::Crossing;
    let Some((planned_s, low_s, high_s)) = crossings() else {
        return Delay {
            method: crossing,
            planned_s: asked_s,
            measured_s: Some(measured.start_s),
            interval_s: None,
        };
    };
    // A plan that rested leaves at an instant of its own; what the smoothing moves the other crossing by is not known.
    let window_s = signals.thresholds.window_s;
    let rested = !planned.reversal && planned.rest_before_s >= 2.0 * window_s;
    let (planned_s, moved_s) = if rested { (asked_s, window_s) } else { (planned_s, 0.0) };
    let measured_s = 0.5 * (low_s + high_s);
    // Noise of the speed over its slope between the two thresholds is noise of the instant.
    let climb_s = (high_s - low_s).max(0.0);
    let deviation_rad_s = signals.deviation_rad_s[measured.samples.start];
    let deviation_s = deviation_rad_s * climb_s / (start - stop).max(f64::MIN_POSITIVE);
    let delay_s = measured_s - planned_s;
    let half_s = NORMAL_975 * deviation_s + blind_s + moved_s;
    let interval_s = Some([delay_s - half_s, delay_s + half_s]);
    Delay { method: crossing, planned_s, measured_s: Some(measured_s), interval_s }
}

/// Times and speeds along the motion, rad/s, of the plan around the start of a motion, smoothed
/// as the measurement is.
fn smoothed_plan<'a>(
    pair: &'a Pair,
    signals: &Signals,
    motion: &Motion,
    rules: &Rules,
) -> (&'a [f64], Vec<f64>) {
    let window_s = signals.thresholds.window_s;
    let reach_s = 3.0 * window_s + rules.min_rest_s;
    let times = &pair.t_s[motion.segment.clone()];
    let first = motion.segment.start + times.partition_point(|&t| t < motion.start_s - reach_s);
    let until_s = motion.end_s.min(motion.start_s + 2.0) + 2.0 * window_s;
    let end = motion.segment.start + times.partition_point(|&t| t <= until_s);
    let t_s = &pair.t_s[first..end];
    let whole = 0..t_s.len();
    let angle_rad = &pair.planned[first..end];
    let fits = local_quadratic(t_s, angle_rad, std::slice::from_ref(&whole), window_s, rules.window_points);
    (t_s, fits.iter().map(|fit| along(motion, fit.velocity)).collect())
}

/// How far after a crossing the fit that showed it sees, s: further than the window where samples are few.
fn reach_s(
    pair: &Pair,
    signals: &Signals,
    motion: &Motion,
    (at, crossing_s): (usize, f64),
    rules: &Rules,
) -> f64 {
    let ahead = (at + rules.window_points / 2).min(motion.segment.end - 1);
    signals.thresholds.window_s.max(pair.t_s[ahead] - crossing_s)
}

/// How long a motion cannot be seen for want of samples and encoder steps, s: the longest of the sample intervals of
/// plan and measurement and of what lies without a sample around the two starts, and the time in which the plan
/// travels half a step.
fn blind_s(
    pair: &Pair,
    signals: &Signals,
    (planned, planned_s): (&Motion, f64),
    (measured, measured_s): (&Motion, f64),
) -> f64 {
    let step_rad = 0.5 * signals.noise.lsb.unwrap_or(0.0);
    let first = planned.samples.start;
    let travelled = |i: &usize| (pair.planned[*i] - pair.planned[first]).abs() >= step_rad;
    let seen = planned.samples.clone().find(travelled).unwrap_or(first);
    let usual_s = signals.sample_interval_s.max(pair.planned_interval_s);
    let gap_s = gap_s(pair, planned, planned_s).max(gap_s(pair, measured, measured_s));
    usual_s.max(gap_s).max(SHAPE_S) + pair.t_s[seen] - pair.t_s[first]
}

/// Time between the two samples around an instant, s.
fn gap_s(pair: &Pair, motion: &Motion, at_s: f64) -> f64 {
    let times = &pair.t_s[motion.segment.clone()];
    let next = times.partition_point(|&t| t <= at_s);
    if next == 0 || next == times.len() { 0.0 } else { times[next] - times[next - 1] }
}

/// The upward crossing of a level nearest to a time, s.
fn upward(t_s: &[f64], speed_rad_s: &[f64], level_rad_s: f64, near_s: f64) -> Option<f64> {
    (1..speed_rad_s.len())
        .filter(|&i| speed_rad_s[i - 1] <= level_rad_s && speed_rad_s[i] > level_rad_s)
        .map(|i| {
            let share = (level_rad_s - speed_rad_s[i - 1]) / (speed_rad_s[i] - speed_rad_s[i - 1]);
            t_s[i - 1] + share * (t_s[i] - t_s[i - 1])
        })
        .min_by(|a, b| (a - near_s).abs().total_cmp(&(b - near_s).abs()))
}

fn onset_of(pair: &Pair, search: &Search, rules: &Rules) -> Option<Onset> {
    onset(&pair.t_s, &pair.measured, search, rules)
}
