//! Finds a sensor that repeats one value while the plan moves.

use std::ops::Range;

use super::{JointKind, Track};
use crate::units::DEGREE_RAD;

/// A plan that moves by this much while the sensor repeats one value is beyond any dead-band.
const FROZEN_PLAN_RAD: f64 = 3.0 * DEGREE_RAD;
/// The same for a joint that slides.
const FROZEN_PLAN_M: f64 = 0.02;

/// Which stretches of one value count.
#[derive(Debug, Clone, Copy)]
struct Least {
    /// They last longer, s.
    lasts_s: f64,
    /// The plan moves that long before their end, s: one that leaves its rest within the last moments meets dead time.
    meets_s: f64,
    /// And by this share of what is beyond any dead band.
    share: f64,
}

const LONG: Least = Least { lasts_s: 0.5, meets_s: 0.5, share: 1.0 };
/// Where noise is seen at rest.
const BRIEF: Least = Least { lasts_s: 0.15, meets_s: 0.0, share: 0.1 };

/// Where nobody can have a joint that stood for a sensor that does: it has noise elsewhere, fewer of whose samples than this share
/// repeat the one before, and repeats at least so many here,
const REPEATS: f64 = 0.02;
const MANY: usize = 20;
/// which may be most of the run where so many times as many samples are elsewhere,
const MOST: f64 = 0.9;
const TELL: usize = 10;
/// or what it shows then jumps, by more than this share of what the plan moved meanwhile and so many times as far as it ever does.
const JUMPS: f64 = 0.5;
const FARTHER: f64 = 3.0;

/// Noise is seen by steps that turn back as often as this share.
const TURNS_BACK: f64 = 0.3;

/// The longest stretch of exactly one measured value that lasts while the plan moves on: from, to, samples.
pub fn frozen(planned: &Track, measured: &Track) -> Option<(f64, f64, u64)> {
    let longest = stretches(planned, measured, LONG)
        .into_iter()
        .reduce(|a, b| if b.len() > a.len() { b } else { a })?;
    let t_s = measured.t_s();
    Some((t_s[longest.start], t_s[longest.end - 1], longest.len() as u64))
}

/// What was measured without stretches in which the sensor surely stood and not the joint; `None` where all is well, or most of
/// the run is such a stretch.
pub fn seen(planned: &Track, measured: &Track) -> Option<Track> {
    let q = measured.position();
    let mut found = stretches(planned, measured, BRIEF);
    if !found.is_empty() && !shows_noise_at_rest(planned, measured) {
        found = stretches(planned, measured, LONG);
    }
    if found.is_empty() {
        return None;
    }
    let mut inside = vec![false; q.len()];
    for stretch in &found {
        inside[stretch.clone()].fill(true);
    }
    let elsewhere = || (1..q.len()).filter(|k| !inside[*k] && !inside[*k - 1]);
    let same = |k: &usize| q[*k].to_bits() == q[*k - 1].to_bits();
    let is_noisy = (elsewhere().filter(same).count() as f64) < REPEATS * elsewhere().count() as f64;
    let farthest = elsewhere().map(|k| (q[k] - q[k - 1]).abs()).fold(0.0, f64::max);
    let surely = |stretch: &&Range<usize>| {
        let jump = q.get(stretch.end).map_or(0.0, |after| (after - q[stretch.start]).abs());
        let [from_s, to_s] = [stretch.start, stretch.end - 1].map(|k| measured.t_s()[k]);
        let jumps = jump > JUMPS * moved(planned, from_s, to_s) && jump > FARTHER * farthest;
        is_noisy && stretch.len() >= MANY || jumps && to_s - from_s > LONG.lasts_s
    };
    let still: Vec<&Range<usize>> = found.iter().filter(surely).collect();
    let stood: usize = still.iter().map(|stretch| stretch.len()).sum();
    let most = if is_noisy && elsewhere().count() >= TELL * MANY { MOST } else { 0.5 };
    if stood == 0 || stood as f64 > most * q.len() as f64 {
        return None;
    }
    // The first sample of a stretch was measured, unless what it shows is a value for faults.
    let mut keeps = vec![true; q.len()];
    for stretch in still {
        let jumped =
            stretch.start > 0 && (q[stretch.start] - q[stretch.start - 1]).abs() > FARTHER * farthest;
        keeps[stretch.start + usize::from(!jumped)..stretch.end].fill(false);
    }
    measured.keeping(|k| keeps[k])
}

/// Whether steps of a sensor turn back while its plan rests, and seldom repeat: noise does, and no joint on its way.
fn shows_noise_at_rest(planned: &Track, measured: &Track) -> bool {
    let (t_s, q) = (measured.t_s(), measured.position());
    let (mut cursor, mut before, mut counts) = (0, None, [0.0; 3]);
    for k in 2..q.len() {
        let plan = planned.held_after(&mut cursor, t_s[k]).position;
        let rests = before.replace(plan) == Some(plan);
        let steps = [q[k - 1] - q[k - 2], q[k] - q[k - 1]];
        // A sensor that stands says nothing of its noise.
        if rests && steps[0] != 0.0 {
            let counted = [true, steps[0] * steps[1] < 0.0, steps[1] == 0.0];
            counts = std::array::from_fn(|of| counts[of] + f64::from(counted[of]));
        }
    }
    let [all, turns_back, repeats] = counts;
    all >= MANY as f64 && turns_back > TURNS_BACK * all && repeats < REPEATS * all
}

/// Stretches of exactly one measured value that last while the plan moves on, by their samples.
fn stretches(planned: &Track, measured: &Track, least: Least) -> Vec<Range<usize>> {
    let (t_s, q) = (measured.t_s(), measured.position());
    let mut found = Vec::new();
    let mut start = 0;
    // A stretch that lasts so long and begins no later than the first sample that is so late holds that sample.
    while let Some(after) = past(&t_s[start..], least.lasts_s) {
        let inside = start + after;
        let same = |i: &usize| q[*i].to_bits() == q[inside].to_bits();
        let first = (start..inside).rev().take_while(same).last().unwrap_or(inside);
        let end = (inside..q.len()).find(|i| !same(i)).unwrap_or(q.len());
        let long = t_s[end - 1] - t_s[first] > least.lasts_s;
        if long && plan_moves(planned, t_s[first], t_s[end - 1] - least.meets_s, least.share) {
            found.push(first..end);
        }
        start = end;
    }
    found
}

/// The first of ascending times that is later than the first of all by more than a span: looked for by strides that
/// double, for it is near.
fn past(t_s: &[f64], span_s: f64) -> Option<usize> {
    let first_s = t_s.first()?;
    let within = |t: &f64| t - first_s <= span_s;
    let mut far = 1;
    while t_s.get(far).is_some_and(within) {
        far *= 2;
    }
    let near = far / 2;
    let at = near + t_s[near..far.min(t_s.len())].partition_point(within);
    (at < t_s.len()).then_some(at)
}

fn plan_moves(planned: &Track, from_s: f64, to_s: f64, share: f64) -> bool {
    let dead = match planned.kind() {
        JointKind::Turns => FROZEN_PLAN_RAD,
        JointKind::Slides => FROZEN_PLAN_M,
    };
    moved(planned, from_s, to_s) > share * dead
}

/// How far a plan moves between two instants.
fn moved(planned: &Track, from_s: f64, to_s: f64) -> f64 {
    let [from, to] = [from_s, to_s].map(|t_s| planned.t_s().partition_point(|&s| s < t_s));
    let plan = &planned.position()[from.min(to)..to];
    let (least, most) = plan.iter().fold((f64::MAX, f64::MIN), |(a, b), &q| (a.min(q), b.max(q)));
    (most - least).max(0.0)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn a_rest_and_the_dead_time_after_it_are_no_frozen_sensor() {
        let track = |at: &dyn Fn(f64) -> f64| Track::sampled("a", 1000, at);
        let moves = |t: f64| 0.5 * (t - 5.0).max(0.0);
        let stands_for = |s: f64| frozen(&track(&moves), &track(&|t| moves(t - s)));
        assert_eq!(stands_for(0.4), None);
        assert!(stands_for(1.0).is_some_and(|(from_s, to_s, _)| from_s < 0.1 && to_s > 5.9));
    }

    #[test]
    fn what_a_sensor_that_stood_showed_was_not_measured_and_a_joint_that_stood_was() {
        let track = |at: &dyn Fn(f64) -> f64| Track::sampled("a", 1000, at);
        let plan = |t: f64| 0.2 * (t - 2.0).clamp(0.0, 6.0);
        let noise = |t: f64| 1e-4 * (1e4 * t).sin();
        let frozen_at = |joint: &dyn Fn(f64) -> f64| {
            let stood = |t: f64| if (4.0..5.0).contains(&t) { joint(4.0) } else { joint(t) };
            seen(&track(&plan), &track(&stood)).map(|seen| seen.len())
        };
        // A noisy sensor repeats nothing, and one without noise does not jump.
        assert_eq!(frozen_at(&|t| plan(t - 0.1) + noise(t)), Some(901));
        assert_eq!(frozen_at(&|t| plan(t - 0.1)), Some(901));
        let whole = |joint: &dyn Fn(f64) -> f64| seen(&track(&plan), &track(joint)).map(|seen| seen.len());
        assert_eq!(whole(&|t| plan(t - 0.1) + noise(t)), None);
        // A joint that stands at a stop, by a sensor without noise, and one that leaves a second late.
        assert_eq!(whole(&|t| plan(t - 0.1).min(0.5)), None);
        assert_eq!(whole(&|t| plan(t - 1.0)), None);
        // Briefly at a start, of a sensor that shows noise at rest.
        let scatter = |t: f64| 1e-4 * (1e7 * t * t).sin();
        let start = |t: f64| if (2.2..2.7).contains(&t) { scatter(2.2) } else { plan(t - 0.3) + scatter(t) };
        assert_eq!(whole(&start), Some(951));
        assert_eq!(whole(&|t| plan(t - 0.3) + scatter(t)), None);
        // To the end of the run.
        let ends = |t: f64| if t < 6.0 { plan(t) + noise(t) } else { 0.8 };
        assert_eq!(whole(&ends), Some(601));
    }

    proptest! {
        #[test]
        fn the_stretch_that_stands_still_is_the_longest_of_all(
            samples in prop::collection::vec((1..400_u32, 0..8_u8, 0..3_u8), 1..40)
        ) {
            let (mut t_s, mut q) = (vec![0.0], vec![0.0]);
            for (step_ms, moves, to) in samples {
                t_s.push(t_s[t_s.len() - 1] + f64::from(step_ms) * 1e-3);
                q.push(if moves == 0 { f64::from(to) } else { q[q.len() - 1] });
            }
            let stretches = q.chunk_by(|a, b| a.to_bits() == b.to_bits()).scan(0, |end, stretch| {
                *end += stretch.len();
                Some((t_s[*end - stretch.len()], t_s[*end - 1], stretch.len() as u64))
            });
            let moved = |from_s: f64, to_s: f64| t_s.iter().filter(|t| (from_s..to_s).contains(*t)).count() > 1;
            let long =
                stretches.filter(|(from_s, to_s, _)| to_s - from_s > LONG.lasts_s && moved(*from_s, to_s - LONG.lasts_s));
            // The first of those that are equally long.
            let expected = long.reduce(|a, b| if b.2 > a.2 { b } else { a });
            let plan = t_s.iter().enumerate().map(|(k, _)| if k % 2 == 0 { 0.0 } else { 1.0 }).collect();
            let plan = Track::new("a", t_s.clone(), plan, &[]).unwrap();
            let measured = Track::new("a", t_s.clone(), q, &[]).unwrap();
            prop_assert_eq!(frozen(&plan, &measured), expected);
        }
    }
}
