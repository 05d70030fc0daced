//! The logs of one joint, cut into runs that can be simulated from their start.

use std::ops::Range;

use super::{
    model::{STEP_S, steps_in},
    simulate::Start,
    zero::shift_rad,
};
use crate::{
    series::{Pair, Series, Signal, Track, align, local_quadratic, noise},
    units::DEGREE_RAD,
};

/// What one log says: the angles that were sent and those that came of them, and the signals to the
/// valves where they were logged.
#[derive(Debug, Clone, Copy)]
pub struct Observation<'a> {
    /// The command if the log has one, else the plan.
    pub sent: &'a Series,
    /// Measured angles.
    pub measured: &'a Series,
    /// Signals to the valves, positive for growing angles; empty where they were not logged.
    pub valve: &'a [Signal],
}

/// Sent speed above which a joint is meant to move, rad/s.
pub(super) const MOVES_RAD_S: f64 = 0.05 * DEGREE_RAD;

/// Rest before a motion that belongs to its run, s.
const BEFORE_S: f64 = 1.0;

/// Rest after a motion that belongs to its run, s. What the integral holds at the end of a motion decides when the next one
/// starts: motions a dwell apart are one run.
const AFTER_S: f64 = 30.0;

/// Shortest run, s.
const SHORTEST_S: f64 = 2.0;

/// Longer motions are cut, s.
const LONGEST_S: f64 = 150.0;

/// After a start in motion the first errors are those of the unknown state, s.
const SETTLE_S: f64 = 0.6;

/// Time over which sent speeds change, s.
pub(super) const ASKED_OVER_S: f64 = 0.1;

/// Length of a block of data that is fitted or predicted, s.
const BLOCK_S: f64 = 3.0;

/// Parts of the data of which each is predicted from the others.
pub(super) const FOLDS: usize = 4;

/// Samples farther apart than this on average show no dynamics, s.
pub const SPARSEST_S: f64 = 0.2;

/// Window of a measured speed, half, s.
const SPEED_WINDOW_S: f64 = 0.1;

/// A speed is reached that is held so long on average, s.
pub(super) const REACHED_OVER_S: f64 = 0.5;

/// Speeds so many samples apart tell an acceleration.
const RISES_OVER: usize = 10;

/// Longest stretch after a start in which its peak error is looked for, s.
const WINDOW_S: f64 = 4.0;

/// A measured sample on the grid of a run.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sample {
    /// Grid point before it.
    pub(super) step: usize,
    /// Part of the way to the next one.
    pub(super) part: f64,
    /// Measured angle, rad.
    pub(super) measured_rad: f64,
    /// Part of the data to which it belongs when each is to be predicted from the others.
    pub(super) fold: usize,
}

impl Sample {
    /// Since the start of its run, s.
    pub(super) fn at_s(&self) -> f64 {
        (self.step as f64 + self.part) * STEP_S
    }
}

/// A stretch of one log without gaps or long rests.
#[derive(Debug, Clone)]
pub(super) struct Run {
    /// Which of the logs, from 0.
    pub(super) log: usize,
    /// The first grid point, s since the start of the log.
    pub(super) from_s: f64,
    /// Angle, rad, and speed, rad/s, every [`STEP_S`].
    pub(super) sent: Vec<(f64, f64)>,
    /// State at the start; the integral is unknown.
    pub(super) start: Start,
    /// Measured angles, in order.
    pub(super) samples: Vec<Sample>,
    /// Largest measured speeds for growing and shrinking angles, rad/s, and changes of speed, rad/s².
    pub(super) reached: [f64; 4],
    /// Largest sent speeds, rad/s, and changes of it, rad/s².
    pub(super) asked: [f64; 4],
    /// Grid points at which the joint is sent off, from rest or backwards.
    pub(super) starts: Vec<usize>,
}

impl Run {
    /// Distance that the joint was sent, rad.
    pub(super) fn travel_rad(&self) -> f64 {
        self.sent.windows(2).map(|w| (w[1].0 - w[0].0).abs()).sum()
    }

    /// Sent angle at a sample, rad.
    pub(super) fn sent_rad(&self, sample: &Sample) -> f64 {
        match self.sent.get(sample.step..sample.step + 2) {
            Some([a, b]) => a.0 + sample.part * (b.0 - a.0),
            _ => f64::NAN,
        }
    }

    /// Where the window after a start ends.
    pub(super) fn window_end(&self, start: usize) -> usize {
        window_end(&self.starts, start)
    }
}

/// Where the window after one of several starts ends: at the next start, or with time.
pub(super) fn window_end(starts: &[usize], start: usize) -> usize {
    let latest = starts.get(start).map_or(0, |at| at + steps_in(WINDOW_S));
    starts.get(start + 1).map_or(latest, |&next| next.min(latest))
}

/// A track every [`STEP_S`]: angle and speed; the speed by differences where the track has none.
pub(super) fn sampled(track: &Track, from_s: f64, steps: usize) -> Vec<(f64, f64)> {
    let at = |k: usize| track.held_at(from_s + k as f64 * STEP_S);
    let mut sent: Vec<(f64, f64)> = (0..steps).map(at).map(|s| (s.position, s.velocity)).collect();
    if track.velocity().is_none() {
        let angle_rad: Vec<f64> = sent.iter().map(|s| s.0).collect();
        for (k, sent) in sent.iter_mut().enumerate() {
            let (before, after) = (k.saturating_sub(1), (k + 1).min(steps - 1));
            let span_s = (after - before).max(1) as f64 * STEP_S;
            sent.1 = (angle_rad[after] - angle_rad[before]) / span_s;
        }
    }
    sent
}

/// Mean distance of measured samples, s, where a joint is sent through `least_rad` or more and they are too far apart.
pub(super) fn sparse_s(sent: &Track, measured: &Track, least_rad: f64) -> Option<f64> {
    let pair = align(sent, measured)?;
    let travel_rad: f64 = pair.planned.windows(2).map(|two| (two[1] - two[0]).abs()).sum();
    let steps = pair.t_s.len().saturating_sub(pair.segments.len());
    let within_s: f64 =
        pair.segments.iter().map(|segment| pair.t_s[segment.end - 1] - pair.t_s[segment.start]).sum();
    let interval_s = within_s / steps as f64;
    (travel_rad >= least_rad && interval_s > SPARSEST_S).then_some(interval_s)
}

/// Runs of one joint in one log.
pub(super) fn runs(sent: &Track, measured: &Track) -> Vec<Run> {
    let Some(mut pair) = align(sent, measured) else { return Vec::new() };
    let zero_rad = zero_rad(&pair, sent, measured);
    pair.measured.iter_mut().for_each(|measured| *measured -= zero_rad);
    let fits = local_quadratic(&pair.t_s, &pair.measured, &pair.segments, SPEED_WINDOW_S, 5);
    let sigma_rad = noise(&pair.t_s, &pair.measured, &pair.segments).sigma;
    let rounded = pair.planned_step.filter(|_| sent.velocity().is_none());
    let mut runs = Vec::new();
    for segment in &pair.segments {
        let (from_s, to_s) = (pair.t_s[segment.start], pair.t_s[segment.end - 1]);
        if to_s - from_s > SPARSEST_S * segment.len() as f64 {
            continue;
        }
        let whole = sampled(sent, from_s, steps_in(to_s - from_s) + 1);
        for steps in motions(&whole) {
            let start_s = from_s + steps.start as f64 * STEP_S;
            let end_s = from_s + (steps.end - 1) as f64 * STEP_S;
            let t_s = &pair.t_s[segment.clone()];
            let first = segment.start + t_s.partition_point(|&t| t < start_s);
            let last = segment.start + t_s.partition_point(|&t| t < end_s);
            if end_s - start_s < SHORTEST_S || last <= first {
                continue;
            }
            let fit = &fits[first];
            let resting = whole[steps.start].1.abs() < MOVES_RAD_S;
            let speed_rad_s = if resting { 0.0 } else { fit.velocity };
            let skipped_s = if resting { 0.0 } else { SETTLE_S };
            let mut samples = Vec::with_capacity(last - first);
            let mut earliest_s = start_s + skipped_s;
            for i in first..last {
                // Denser samples than the model's steps add nothing but noise that is not white.
                if pair.t_s[i] < earliest_s {
                    continue;
                }
                earliest_s = pair.t_s[i] + 0.8 * STEP_S;
                let at = (pair.t_s[i] - start_s) / STEP_S;
                let step = steps_in(at * STEP_S).min(steps.len() - 2);
                let measured_rad = pair.measured[i];
                samples.push(Sample { step, part: at - step as f64, measured_rad, fold: fold(step) });
            }
            let extreme = |of: &dyn Fn(usize) -> f64| (first..last).map(of).fold(0.0, f64::max);
            let fastest = fastest_rad_s(&pair.t_s[first..last], &pair.measured[first..last]);
            let rise = |i: usize| {
                let before = i.saturating_sub(RISES_OVER).max(first);
                let span_s = (pair.t_s[i] - pair.t_s[before]).max(STEP_S);
                (fits[i].velocity - fits[before].velocity) / span_s
            };
            let sharpest = [1.0, -1.0].map(|way| extreme(&|i| way * rise(i)));
            let interval_s = (pair.t_s[last - 1] - pair.t_s[first]) / (last - first) as f64;
            let [by_speed, by_rise] = made_by_noise(sigma_rad, interval_s);
            let fastest = fastest.map(|speed| (speed - by_speed).max(0.0));
            let sharpest = sharpest.map(|rise| (rise - by_rise).max(0.0));
            let sent = whole[steps.clone()].to_vec();
            runs.push(Run {
                log: 0,
                from_s: start_s,
                asked: asked(&sent),
                starts: rounded.map_or_else(|| starts(&sent), |step| starts(&calmed(&sent, step))),
                sent,
                start: Start { angle_rad: fit.position, speed_rad_s, integral_rad_s: 0.0 },
                samples,
                reached: [fastest[0], fastest[1], sharpest[0], sharpest[1]],
            });
        }
    }
    runs
}

/// The zero that a joint was measured from, rad: no loop sees that it is another than that of what was sent.
fn zero_rad(pair: &Pair, sent: &Track, measured: &Track) -> f64 {
    let (mut t_s, mut planned) = (Vec::new(), Vec::new());
    for segment in &pair.segments {
        let (from_s, to_s) = (pair.t_s[segment.start], pair.t_s[segment.end - 1]);
        if to_s - from_s <= SPARSEST_S * segment.len() as f64 {
            let steps = steps_in(to_s - from_s) + 1;
            planned.extend(sampled(sent, from_s, steps));
            t_s.extend((0..steps).map(|k| from_s + k as f64 * STEP_S));
        }
    }
    shift_rad(&planned, |k| Some(measured.at(t_s[k])?.position - planned[k].0))
}

/// Deviations of noise in the largest of many speeds.
const DEVIATIONS: f64 = 3.0;

/// What noise of positions makes of the largest speed, rad/s, and of the largest acceleration, rad/s², where there is none.
fn made_by_noise(sigma_rad: f64, interval_s: f64) -> [f64; 2] {
    let both_rad = DEVIATIONS * std::f64::consts::SQRT_2 * sigma_rad;
    let interval_s = interval_s.max(f64::MIN_POSITIVE);
    let within = (2.0 * SPEED_WINDOW_S / interval_s).max(5.0);
    let of_slope = (3.0 / within).sqrt() / SPEED_WINDOW_S;
    [both_rad / REACHED_OVER_S, both_rad * of_slope / (RISES_OVER as f64 * interval_s).max(STEP_S)]
}

/// Largest mean speeds for growing and shrinking angles, rad/s: over a time in which noise averages out.
fn fastest_rad_s(t_s: &[f64], angle_rad: &[f64]) -> [f64; 2] {
    let mut fastest = [0.0_f64; 2];
    for (from, from_s) in t_s.iter().enumerate() {
        let to = t_s.partition_point(|t_s| t_s - from_s < REACHED_OVER_S);
        if let Some(to_s) = t_s.get(to) {
            let speed_rad_s = (angle_rad[to] - angle_rad[from]) / (to_s - from_s);
            fastest = [fastest[0].max(speed_rad_s), fastest[1].max(-speed_rad_s)];
        }
    }
    fastest
}

/// Largest sent speeds for growing and shrinking angles, rad/s, and changes of speed over a tenth of
/// a second, rad/s².
fn asked(sent: &[(f64, f64)]) -> [f64; 4] {
    let span = steps_in(ASKED_OVER_S).max(1);
    let mut asked = [0.0_f64; 4];
    for (k, now) in sent.iter().enumerate() {
        let before = sent[k.saturating_sub(span)].1;
        let change = (now.1 - before) / (span as f64 * STEP_S);
        for (most, value) in asked.iter_mut().zip([now.1, -now.1, change, -change]) {
            *most = most.max(value);
        }
    }
    asked
}

/// Grid points of motions with some rest around them; long rests are left out, long motions cut where they are
/// slowest.
fn motions(sent: &[(f64, f64)]) -> Vec<Range<usize>> {
    let (before, after) = (steps_in(BEFORE_S), steps_in(AFTER_S));
    let mut motions: Vec<Range<usize>> = Vec::new();
    for (k, _) in sent.iter().enumerate().filter(|(_, sent)| sent.1.abs() > MOVES_RAD_S) {
        let end = (k + 1 + after).min(sent.len());
        match motions.last_mut() {
            Some(last) if last.end + before >= k => last.end = end,
            _ => motions.push(k.saturating_sub(before)..end),
        }
    }
    motions.into_iter().flat_map(|whole| pieces(sent, whole)).collect()
}

/// A motion, cut into pieces if it is long.
fn pieces(sent: &[(f64, f64)], mut whole: Range<usize>) -> Vec<Range<usize>> {
    let mut pieces = Vec::new();
    while whole.len() > steps_in(LONGEST_S) {
        let earliest = whole.start + steps_in(LONGEST_S) / 3;
        let slowest = (earliest..2 * earliest - whole.start)
            .min_by(|a, b| sent[*a].1.abs().total_cmp(&sent[*b].1.abs()))
            .unwrap_or(earliest);
        pieces.push(whole.start..slowest);
        whole.start = slowest;
    }
    pieces.push(whole);
    pieces
}

/// Where a joint is sent off: from rest, or backwards.
pub(super) fn starts(sent: &[(f64, f64)]) -> Vec<usize> {
    let mut starts = Vec::new();
    let mut way = 0;
    for (k, (_, speed_rad_s)) in sent.iter().enumerate() {
        let now = i8::from(*speed_rad_s > MOVES_RAD_S) - i8::from(*speed_rad_s < -MOVES_RAD_S);
        if now != 0 && now != way {
            starts.push(k);
        }
        way = now;
    }
    starts
}

/// Half of the time over which steps of rounded numbers become a speed, s, and of how many steps in it rest is told from motion.
const CALM_S: f64 = 0.2;
const CALM_STEPS: f64 = 1.5;

/// What was sent in steps of rounded numbers, each of which would be a start: its mean speed over a time, and rest below what a step
/// makes of that.
fn calmed(sent: &[(f64, f64)], step_rad: f64) -> Vec<(f64, f64)> {
    let (half, least_rad_s) = (steps_in(CALM_S), CALM_STEPS * step_rad / (2.0 * CALM_S));
    let speed_rad_s = |k: usize| {
        let (from, to) = (k.saturating_sub(half), (k + half).min(sent.len() - 1));
        (sent[to].0 - sent[from].0) / ((to - from).max(1) as f64 * STEP_S)
    };
    let calm = |speed: f64| if speed.abs() > least_rad_s { speed } else { 0.0 };
    (0..sent.len()).map(|k| (sent[k].0, calm(speed_rad_s(k)))).collect()
}

/// Deals the time of a run, in blocks, to [`FOLDS`] parts in turn for each to be predicted from the
/// others. Longer parts would leave a fit without starts in one direction.
fn fold(step: usize) -> usize {
    step / steps_in(BLOCK_S).max(1) % FOLDS
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plan_in_steps_of_rounded_numbers_starts_once() {
        // Rest, 1 deg/s for 4 s, rest.
        for step_rad in [0.1, 0.01, 0.001].map(|deg| deg * DEGREE_RAD) {
            let along = |k: usize| (k as f64 - 100.0).clamp(0.0, 400.0) * STEP_S * DEGREE_RAD;
            let at = |k: usize| (along(k) / step_rad).round() * step_rad;
            let speed = |k: usize| (at(k + 1) - at(k.saturating_sub(1))) / (2.0 * STEP_S);
            let sent: Vec<(f64, f64)> = (0..700).map(|k| (at(k), speed(k))).collect();
            let found = starts(&calmed(&sent, step_rad));
            assert!(found.len() == 1 && found[0].abs_diff(100) < 40, "{step_rad}: {found:?}");
        }
    }

    #[test]
    fn a_zero_that_is_shifted_is_no_error_and_what_a_joint_is_off_by_at_one_end_is() {
        // There and back at 0.1 rad/s, 0.2 s late.
        let along = |t_s: f64| 0.1 * ((t_s - 2.0).clamp(0.0, 3.0) - (t_s - 8.0).clamp(0.0, 3.0));
        let sent = Track::sampled("boom", 1500, along);
        let angles = |off: &dyn Fn(f64) -> f64| -> Vec<f64> {
            let measured = Track::sampled("boom", 1500, |t_s| along(t_s - 0.2) + off(t_s));
            let found = runs(&sent, &measured);
            found.iter().flat_map(|run| &run.samples).map(|sample| sample.measured_rad).collect()
        };
        let own = angles(&|_| 0.0);
        let most = |other: &[f64]| own.iter().zip(other).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let shifted = angles(&|_| 0.05);
        assert!(own.len() == shifted.len() && most(&shifted) < 1e-9, "{}", most(&shifted));
        let sinks = angles(&|t_s| if t_s > 7.0 { 0.05 } else { 0.0 });
        assert!((most(&sinks) - 0.05).abs() < 1e-9, "{}", most(&sinks));
    }
}
