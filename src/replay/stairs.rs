//! When a plan that was rounded left rest: between two of its values the plan itself passes the middle, and rises through
//! these middles say when they began, although the first step of the stairs shows later.

use super::{
    Rules,
    motion::Motion,
    onset::{Onset, RISES, Rise, SMOOTH, quantiles},
    unrounded::{NONE, climbs_to},
};
use crate::{math::median, series::Pair};

/// So many middles are fitted: farther up no rise has the shape of its start.
const MOST: usize = 6;
/// Ramps of plans that are slow or begin at their speed, s.
const RAMPS: [Rise; 4] = [Rise::Ramp(0.002), Rise::Ramp(0.4), Rise::Ramp(0.8), Rise::Ramp(1.6)];
/// What a rise of another shape lies off a middle by, in steps.
const SHAPE: f64 = 0.03;
/// Where no shape comes nearer than this to the middles, in mean squares of what one may lie off, none says when they began.
const MOST_UNLIKE: f64 = 6.0;
/// From a departure to the first step, by the time from there to the next: what rises with the third power of time takes 2.3 times as long.
const BEFORE: f64 = 2.3;
/// Changes of more steps than this at a time, so many of them, tell how long a plan holds each value.
const SEVERAL: f64 = 1.5;
const ENOUGH: usize = 4;
/// A rest lies within half a step of its value; so much more is let pass, in steps.
const OFF_REST: f64 = 0.55;

/// The onset of a motion of a plan in steps, by a threshold of speed. `None` where the first
/// samples are equally far apart, or each farther than the one before: the start then lies beside the first that moves.
pub(super) fn onset(
    pair: &Pair,
    motion: &Motion,
    step: f64,
    stop_speed: f64,
    rules: &Rules,
) -> Option<Onset> {
    let middles = middles(pair, motion, step)?;
    let first_s = middles[0].t_s;
    let rest_s = rules.onset_rest_share * (motion.rest_before_s + (first_s - motion.start_s).max(0.0));
    let steps = (rest_s / rules.onset_step_s).clamp(0.0, 2000.0).floor();
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped above")]
    let departures = (0..=steps as usize).map(|k| first_s - k as f64 * rules.onset_step_s);
    let rises = || RISES[..SMOOTH].iter().chain(&RAMPS);
    let each = departures.flat_map(|t0_s| rises().map(move |rise| (t0_s, *rise)));
    let likely = each.filter_map(|(t0_s, rise)| fit(&middles, (t0_s, rise), step, stop_speed));
    let mut likely: Vec<(f64, f64)> = likely.collect();
    // Where no shape is that of the plan, each says less.
    let least = likely.iter().map(|one| one.1).fold(f64::INFINITY, f64::min);
    let freedom = middles.len().saturating_sub(3).max(1) as f64;
    let unlike = (2.0 * least / freedom).max(1.0);
    if unlike > MOST_UNLIKE {
        // What shows is its first step, and the time to that from the departure is some of that to the next one.
        let changes = motion.samples.start.max(motion.segment.start + 1)..motion.segment.end;
        let mut shown_s = changes.filter(|at| change(pair, motion, *at) > NONE * step).map(|at| pair.t_s[at]);
        let (shows_s, next_s) = shown_s.next().zip(shown_s.next())?;
        return Some(Onset { at_s: shows_s, interval_s: [shows_s - BEFORE * (next_s - shows_s), shows_s] });
    }
    for one in &mut likely {
        one.1 /= unlike;
    }
    let [low_s, at_s, high_s] = quantiles(likely, [0.025, 0.5, 0.975])?;
    Some(Onset { at_s, interval_s: [low_s - rules.onset_step_s, high_s + rules.onset_step_s] })
}

/// A first change of so many times the next one is of a plan that was written once it had gone so far.
const JUMPS: f64 = 1.5;
/// So many samples before it have one value.
const HELD: usize = 3;
/// What rises with the fourth power of time takes so many times as long to one distance as from there to twice as far, and a bit less.
const TO_BAND: f64 = 5.0;

/// Between which instants a joint or its plan left whose values `x` are written only where they changed by some band: at the first change
/// it had gone that far, and it was at rest when the value before was written. `None` of others.
pub(super) fn within_band(t_s: &[f64], x: &[f64], motion: &Motion) -> Option<[f64; 2]> {
    let segment = &motion.segment;
    let change = |at: usize| f64::from(motion.direction) * (x[at] - x[at - 1]);
    let seen = (motion.samples.start.max(segment.start + 1)..segment.end).find(|at| change(*at) > 0.0)?;
    let first = (segment.start + 1..=seen).rev().take_while(|at| change(*at) > 0.0).last()?;
    let held = first.checked_sub(HELD).filter(|from| *from >= segment.start)?;
    let stands = (held + 1..first).all(|at| x[at].to_bits() == x[at - 1].to_bits());
    let (jump, next) = (change(first), (first + 1 < segment.end).then(|| change(first + 1))?);
    if !stands || next <= 0.0 || jump < JUMPS * next {
        return None;
    }
    let gone = |at: &usize| f64::from(motion.direction) * (x[*at] - x[first]) >= jump;
    let twice = (first + 1..segment.end).find(gone)?;
    let longest_s = TO_BAND * (t_s[twice] - t_s[first]);
    let rests_s = motion.start_s - motion.rest_before_s;
    Some([(t_s[first] - longest_s).max(rests_s.min(t_s[first])), t_s[first]])
}

/// The change of a plan to a sample from the one before, along a motion.
fn change(pair: &Pair, motion: &Motion, at: usize) -> f64 {
    f64::from(motion.direction) * (pair.planned[at] - pair.planned[at - 1])
}

/// The first sample whose value is not that at rest: a smoothed speed is seen before it or after.
fn first(pair: &Pair, motion: &Motion, step: f64) -> Option<usize> {
    let segment = motion.segment.start + 1..motion.segment.end;
    let moves = |at: &usize| change(pair, motion, *at) > NONE * step;
    let seen = (motion.samples.start.max(segment.start)..segment.end).find(moves)?;
    let rests_s = motion.start_s - motion.rest_before_s;
    let back = (segment.start..=seen).rev().take_while(|&at| pair.t_s[at] >= rests_s);
    back.take_while(|&at| change(pair, motion, at) >= -NONE * step).filter(moves).last().or(Some(seen))
}

/// Where the plan passes between two values, the first ones.
fn middles(pair: &Pair, motion: &Motion, step: f64) -> Option<Vec<Middle>> {
    let (t_s, x, end) = (&pair.t_s, &pair.planned, motion.segment.end);
    let first = first(pair, motion, step)?;
    let held_s = hold_s(pair, motion, step);
    let (mut middles, mut heights, mut stands) = (Vec::new(), Vec::new(), false);
    let mut at = first;
    while at < end && middles.len() < MOST {
        if change(pair, motion, at) <= NONE * step {
            stands = true;
            at += 1;
            continue;
        }
        let from = at - 1;
        at = climbs_to(x, at, end, step);
        heights.push(f64::from(motion.direction) * (x[at] - x[from]));
        let between_s = (t_s[at] - t_s[from]).max(held_s);
        middles.push(Middle {
            t_s: t_s[at] - 0.5 * between_s,
            travel: f64::from(motion.direction) * (0.5 * (x[from] + x[at]) - x[first - 1]),
            between_s,
            weight: 1.0,
        });
        at += 1;
    }
    let even = heights.windows(2).all(|two| (two[1] - two[0]).abs() <= NONE * step);
    let rises = heights.windows(2).all(|two| two[1] - two[0] > NONE * step);
    weigh(&mut middles, step);
    (middles.len() > 1 && (stands || !even && !rises)).then_some(middles)
}

/// How long a plan holds each value in a motion, s; 0 where it changes by too few steps at a time to tell.
fn hold_s(pair: &Pair, motion: &Motion, step: f64) -> f64 {
    let (first, end) = (motion.samples.start.max(motion.segment.start + 1), motion.samples.end);
    let changes = (first..end).filter(|&at| change(pair, motion, at).abs() > NONE * step);
    let changes: Vec<(f64, f64)> =
        changes.map(|at| (pair.t_s[at], change(pair, motion, at).abs() / step)).collect();
    let several = changes.windows(2).filter(|two| two.iter().all(|change| change.1 > SEVERAL));
    let held_s: Vec<f64> = several.map(|two| two[1].0 - two[0].0).collect();
    if held_s.len() < ENOUGH { 0.0 } else { median(held_s) }
}

/// Where a plan passes the middle between two of its values.
#[derive(Clone, Copy)]
struct Middle {
    t_s: f64,
    /// From the value at rest.
    travel: f64,
    /// Time between the two samples around it, s.
    between_s: f64,
    /// Inverse variance of the travel, in steps.
    weight: f64,
}

/// Weighs each middle by the travel in the time in which it is not seen.
fn weigh(middles: &mut [Middle], step: f64) {
    let slopes: Vec<f64> = (0..middles.len())
        .map(|k| {
            let (a, b) = (middles[k.saturating_sub(1)], middles[(k + 1).min(middles.len() - 1)]);
            (b.travel - a.travel) / step / (b.t_s - a.t_s)
        })
        .collect();
    for (middle, slope_s) in middles.iter_mut().zip(slopes) {
        middle.weight = 1.0 / (SHAPE * SHAPE + (slope_s * middle.between_s).powi(2) / 12.0);
    }
}

/// When a rise from a departure on, of the best rest level and scale, passes the speed, and minus the logarithm of its
/// likelihood; `None` if it never does, or its rest would have been another value.
fn fit(middles: &[Middle], (t0_s, rise): (f64, Rise), step: f64, stop_speed: f64) -> Option<(f64, f64)> {
    let risen = || middles.iter().map(|m| (rise.travel((m.t_s - t0_s).max(0.0)), m.travel, m.weight));
    let all = risen().map(|(.., w)| w).sum::<f64>();
    let mean_f = risen().map(|(f, _, w)| w * f).sum::<f64>() / all;
    let mean_x = risen().map(|(_, x, w)| w * x).sum::<f64>() / all;
    let spread = risen().map(|(f, _, w)| w * (f - mean_f).powi(2)).sum::<f64>();
    let scale = risen().map(|(f, x, w)| w * (f - mean_f) * (x - mean_x)).sum::<f64>() / spread;
    let level = mean_x - scale * mean_f;
    // Until its first value it was written as it rests.
    let rests = |first: &Middle| {
        let until_s = first.t_s - 0.5 * first.between_s;
        level + scale * rise.travel((until_s - t0_s).max(0.0)) <= OFF_REST * step
    };
    let off_rest = level.abs() > OFF_REST * step || !middles.first().is_some_and(rests);
    if !(scale > 0.0 && scale.is_finite()) || off_rest {
        return None;
    }
    let squares = risen().map(|(f, x, w)| w * (x - level - scale * f).powi(2)).sum::<f64>();
    // Beyond what is seen of it a rise goes on by its shape alone.
    let passes_s = t0_s + rise.passes_s(scale, stop_speed)?;
    middles
        .last()
        .is_some_and(|last| passes_s <= last.t_s)
        .then_some((passes_s, 0.5 * squares / (step * step)))
}
