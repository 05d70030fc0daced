//! Slow swings of a joint while its plan rests, which a spectrum does not tell from motions: a loop that hunts.

use std::ops::Range;

use super::{Rules, rules::Sizes};
use crate::{math::median, series::Pair};

/// What comes this long after the plan has come to rest is its motion's, s.
const SETTLES_S: f64 = 1.0;
/// Turns count that are so many standard deviations of the noise apart, or the least of a swing.
const SIGMAS: f64 = 8.0;
/// A swing has so many ways from turn to turn at least, nine tenths of which take no more than so many times the usual one, and no less.
const FEWEST: usize = 4;
const REGULAR: f64 = 1.6;
const MOST_OF_THEM: f64 = 0.9;

/// Frequency, Hz, and amplitude of a joint that swings where its plan rests; `None` of one that does not. `sigma`: of its noise.
pub(super) fn rest_swing(pair: &Pair, sigma: f64, rules: &Rules) -> Option<[f64; 2]> {
    let sizes = rules.sizes(pair.kind);
    let least = sizes.displacement.max(SIGMAS * sigma);
    let ways = rests(pair, sizes).into_iter().flat_map(|rest| ways(pair, rest, least));
    let (times_s, sizes): (Vec<f64>, Vec<f64>) = ways.unzip();
    if times_s.len() < FEWEST {
        return None;
    }
    let usual_s = median(times_s.clone());
    let regular = |time_s: &&f64| (usual_s / REGULAR..=usual_s * REGULAR).contains(*time_s);
    let count = times_s.iter().filter(regular).count();
    let most = count as f64 >= MOST_OF_THEM * times_s.len() as f64;
    most.then(|| [0.5 / usual_s, 0.5 * median(sizes)])
}

/// The rests of the plan in each stretch, without their first second.
fn rests(pair: &Pair, sizes: &Sizes) -> Vec<Range<usize>> {
    let rests = |segment: &Range<usize>| {
        let mut found = Vec::new();
        let mut from = segment.start;
        while from < segment.end {
            let near = |k: &usize| (pair.planned[*k] - pair.planned[from]).abs() <= 0.5 * sizes.min_travel;
            let end = from + (from..segment.end).take_while(near).count();
            let settled = pair.t_s.partition_point(|t_s| *t_s < pair.t_s[from] + SETTLES_S);
            if settled < end {
                found.push(settled..end);
            }
            from = end;
        }
        found
    };
    pair.segments.iter().flat_map(rests).collect()
}

/// Time, s, and size of each way from turn to turn within a rest.
fn ways(pair: &Pair, rest: Range<usize>, least: f64) -> Vec<(f64, f64)> {
    let mut turns: Vec<(f64, f64)> = Vec::new();
    let Some(first) = rest.clone().next() else { return Vec::new() };
    let (mut high, mut low) = (first, first);
    // Whether the next turn is a high one; unknown at first.
    let mut rises: Option<bool> = None;
    let q = |k: usize| pair.measured[k] - pair.planned[k];
    for k in rest {
        if q(k) > q(high) {
            high = k;
        }
        if q(k) < q(low) {
            low = k;
        }
        let turned_down = rises != Some(false) && q(high) - q(k) >= least;
        let turned_up = rises != Some(true) && q(k) - q(low) >= least;
        if turned_down || turned_up {
            let turn = if turned_down { high } else { low };
            // The first turn may be where the rest begins.
            if rises.is_some() {
                turns.push((pair.t_s[turn], q(turn)));
            }
            rises = Some(turned_up);
            (high, low) = (k, k);
        }
    }
    turns.windows(2).map(|two| (two[1].0 - two[0].0, (two[1].1 - two[0].1).abs())).collect()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::{
        math::smooth_step,
        series::{Track, align},
    };

    fn of(course: impl Fn(f64) -> f64) -> Option<[f64; 2]> {
        let plan = |t: f64| 0.3 * smooth_step((t - 8.0) / 4.0) + 0.2 * smooth_step((t - 24.0) / 3.0);
        let noise = |t: f64| 1e-4 * (1e4 * t * t).sin();
        let pair = align(
            &Track::sampled("boom", 4000, plan),
            &Track::sampled("boom", 4000, |t| plan(t - 0.2) + course(t) + noise(t)),
        )?;
        rest_swing(&pair, 1e-4, &Rules::default())
    }

    #[test]
    fn a_loop_that_hunts_slowly_is_told_with_frequency_and_amplitude() {
        for hz in [0.2, 0.3, 0.5, 0.8] {
            let [found, amplitude] = of(|t| 0.01 * (TAU * hz * t).sin()).unwrap_or_else(|| panic!("{hz} Hz"));
            assert!((found / hz - 1.0).abs() < 0.05, "{hz} Hz: {found}");
            assert!((amplitude / 0.01 - 1.0).abs() < 0.1, "{hz} Hz: {amplitude}");
        }
    }

    #[test]
    fn what_rests_sinks_settles_or_wanders_does_not_swing() {
        assert_eq!(of(|_| 0.0), None);
        assert_eq!(of(|t| -2e-3 * t), None, "sinks");
        assert_eq!(of(|t| 0.02 * (-t % 8.0).exp()), None, "settles");
        let wanders = |t: f64| 0.01 * ((0.2 * t).sin() + (0.09 * t).cos());
        assert_eq!(of(wanders), None, "wanders");
    }
}
