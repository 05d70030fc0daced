//! Finds a stretch of motion within a longer one.

use super::{Series, Track, track::span_s};
use crate::math::whole;

/// Where a motion was found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Located {
    /// Time in the longer series at which the motion's own time is 0, s.
    pub at_s: f64,
    /// Root mean square difference between the two, over all joints, rad.
    pub rms_rad: f64,
    /// Root mean square of the motion about its mean, rad: the difference to a series at rest.
    pub spread_rad: f64,
    /// Joints of both.
    pub joints: usize,
    /// Other places that fit as well.
    pub others: usize,
    /// Share of the motion that lies within the longer series, of one of which less than four fifths do; else 1.
    pub covered: f64,
    /// Length of the motion in the longer series by its own, where it fits clearly better at another than 1, for clocks that run
    /// apart: `rms_rad` is what is then left; `at_s` is of 1.
    pub pace: Option<f64>,
}

impl Located {
    /// Whether the two run apart by as much as is looked for, or more.
    pub fn is_apart_by_most(&self) -> bool {
        self.pace.is_some_and(|pace| (pace - 1.0).abs() > 0.99 * MOST_APART)
    }
}

/// Step of the first look, s.
const STEP_S: f64 = 0.1;
/// Share of the motion that must lie within the longer series.
const COVERED: f64 = 0.8;
/// The same of a run that was stopped, or recorded late: what there is of it moves by a share of the whole, and fits closely.
const PART_COVERED: f64 = 0.3;
const PART_MOVES: f64 = 0.3;
const PART_FITS: f64 = 0.02;
const WHOLE_FITS: f64 = 0.1;
/// Longest series that is looked through, s.
const LONGEST_S: f64 = 250_000.0;
/// Less than this is no motion, rad.
const LEAST_RAD: f64 = 1e-4;
/// Instants at which a place is judged in the end.
const INSTANTS: usize = 2_000;
/// Places of the first look that are looked at again.
const PLACES: usize = 8;
/// Places whose differences are within this factor, or within this share of the motion, fit equally well.
const ALIKE: f64 = 1.5;
const ALIKE_SHARE: f64 = 0.01;
/// Clocks that run apart do so by this at most, and show if that halves what is left.
const MOST_APART: f64 = 0.03;
const CLEARLY: f64 = 0.5;
/// Clocks that run apart by less over the motion agree, s.
const LEAST_APART_S: f64 = 0.01;
/// Instants at which a pace is judged.
const PACE_INSTANTS: usize = 400;

/// The joints of both.
fn pairs<'a>(motion: &'a Series, within: &'a Series) -> Vec<(&'a Track, &'a Track)> {
    let both = |track: &'a Track| Some((track, within.track(track.name())?));
    motion.tracks.iter().filter_map(both).filter(|(one, other)| one.kind() == other.kind()).collect()
}

/// Looks for `motion` in `within` by its positions, over the joints of both; a metre counts as a radian. Of equally good
/// places the first. `None` if they share no joint, the motion does not move, less than four fifths of it lie within and no part of it
/// that fits closely, or one lasts three days.
pub fn locate(motion: &Series, within: &Series) -> Option<Located> {
    let pairs = pairs(motion, within);
    let whole = located(&pairs, COVERED);
    let fits = |found: &Located, share: f64| found.rms_rad <= share * found.spread_rad;
    if whole.is_some_and(|found| fits(&found, WHOLE_FITS)) {
        return whole;
    }
    let part = located(&pairs, PART_COVERED).filter(|found| fits(found, PART_FITS) && found.pace.is_none());
    part.or(whole)
}

fn located(pairs: &[(&Track, &Track)], covered: f64) -> Option<Located> {
    let [from_s, to_s] = span_s(pairs.iter().map(|pair| pair.0))?;
    let [start_s, end_s] = span_s(pairs.iter().map(|pair| pair.1))?;
    let spread = spread_rad(pairs, from_s, to_s);
    if spread < LEAST_RAD {
        return None;
    }
    let length_s = to_s - from_s;
    // The motion may stick out at either end.
    let earliest_s = start_s - (1.0 - covered) * length_s;
    let latest_s = end_s - covered * length_s;
    let first = first_look(pairs, [from_s, to_s], [earliest_s, latest_s], covered)?;
    let judge = |at_s: f64| left_rad(pairs, [from_s, to_s], (at_s, 1.0), INSTANTS, covered);
    // What of it lies within, where its first sample lies at `at_s`.
    let within_s = |at_s: f64| [from_s + (start_s - at_s).max(0.0), to_s.min(from_s + end_s - at_s)];
    let moves = |at_s: f64| {
        let [low_s, high_s] = within_s(at_s);
        covered >= COVERED || spread_rad(pairs, low_s, high_s) >= PART_MOVES * spread
    };
    let mut found: Vec<(f64, f64)> = Vec::new();
    for near_s in first {
        let at_s = least(&judge, near_s - STEP_S, near_s + STEP_S);
        if let Some(rms_rad) = judge(at_s).filter(|_| moves(at_s)) {
            found.push((at_s, rms_rad));
        }
    }
    let best_rad = found.iter().map(|place| place.1).min_by(f64::total_cmp)?;
    found.retain(|place| place.1 <= (ALIKE * best_rad).max(ALIKE_SHARE * spread));
    let (at_s, rms_rad) = found.iter().copied().min_by(|a, b| a.0.total_cmp(&b.0))?;
    let (pace, rms_rad) =
        paced(pairs, [from_s, to_s], at_s).map_or((None, rms_rad), |paced| (Some(paced.0), paced.1));
    let (joints, others) = (pairs.len(), found.len() - 1);
    let [low_s, high_s] = within_s(at_s);
    let covered = if covered < COVERED { (high_s - low_s) / length_s } else { 1.0 };
    Some(Located { at_s: at_s - from_s, rms_rad, spread_rad: spread, joints, others, pace, covered })
}

/// Difference between a motion and a longer one in which its own time 0 lies at `at_s`, as a share of the motion; infinite where less than
/// three tenths of it lie within. `None` if they share no joint or the motion does not move.
pub fn left_at(motion: &Series, within: &Series, at_s: f64) -> Option<f64> {
    let pairs = pairs(motion, within);
    let [from_s, to_s] = span_s(pairs.iter().map(|pair| pair.0))?;
    let spread_rad = spread_rad(&pairs, from_s, to_s);
    let left = left_rad(&pairs, [from_s, to_s], (at_s + from_s, 1.0), INSTANTS, PART_COVERED);
    (spread_rad >= LEAST_RAD).then(|| left.map_or(f64::INFINITY, |left_rad| left_rad / spread_rad))
}

/// The pace at which a motion fits clearly better than at 1, and what is then left, rad.
fn paced(pairs: &[(&Track, &Track)], [from_s, to_s]: [f64; 2], at_s: f64) -> Option<(f64, f64)> {
    let length_s = to_s - from_s;
    let left = |pace: f64, at_s: f64| left_rad(pairs, [from_s, to_s], (at_s, pace), PACE_INSTANTS, COVERED);
    // About the middle, place and pace hardly depend on each other.
    let place = |pace: f64| {
        let middle_s = at_s + 0.5 * (1.0 - pace) * length_s;
        let away_s = (1.0 - pace).abs() * length_s + STEP_S;
        least(&|at_s| left(pace, at_s), middle_s - away_s, middle_s + away_s)
    };
    let best = least(&|pace| left(pace, place(pace)), 1.0 - MOST_APART, 1.0 + MOST_APART);
    let found_rad = left(best, place(best))?;
    let shows = (best - 1.0).abs() * length_s > LEAST_APART_S && found_rad < CLEARLY * left(1.0, at_s)?;
    shows.then_some((best, found_rad))
}

/// The best places of a coarse grid, at least half a motion apart: when its first sample lies there, s.
fn first_look(
    pairs: &[(&Track, &Track)],
    [from_s, to_s]: [f64; 2],
    [earliest_s, latest_s]: [f64; 2],
    covered: f64,
) -> Option<Vec<f64>> {
    if to_s - from_s > LONGEST_S || latest_s - earliest_s > LONGEST_S {
        return None;
    }
    let count = |span_s: f64| whole(span_s / STEP_S) + 1;
    let (instants, shifts) = (count(to_s - from_s), count(latest_s - earliest_s));
    let on_grid = |track: &Track, start_s: f64, count: usize| -> Vec<f64> {
        let mut cursor = 0;
        let at = |k| {
            let state = track.at_after(&mut cursor, start_s + k as f64 * STEP_S);
            state.map_or(f64::NAN, |state| state.position)
        };
        (0..count).map(at).collect()
    };
    let grids: Vec<_> = pairs
        .iter()
        .map(|(motion, within)| {
            let wanted: Vec<f64> =
                (0..instants).map(|k| motion.held_at(from_s + k as f64 * STEP_S).position).collect();
            (wanted, on_grid(within, earliest_s, instants + shifts))
        })
        .collect();
    let left = |shift: usize| {
        let (mut sum, mut seen) = (0.0, 0_usize);
        for (wanted, there) in &grids {
            for (a, b) in wanted.iter().zip(&there[shift..]) {
                if b.is_finite() {
                    sum += (a - b) * (a - b);
                    seen += 1;
                }
            }
        }
        let enough = seen as f64 >= covered * (instants * grids.len()) as f64;
        enough.then(|| sum / seen as f64)
    };
    let mut places: Vec<(f64, f64)> =
        (0..shifts).filter_map(|shift| Some((left(shift)?, earliest_s + shift as f64 * STEP_S))).collect();
    places.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let mut apart: Vec<f64> = Vec::new();
    for (_, at_s) in places {
        if apart.len() < PLACES && apart.iter().all(|other| (other - at_s).abs() >= 0.5 * (to_s - from_s)) {
            apart.push(at_s);
        }
    }
    (!apart.is_empty()).then_some(apart)
}

/// Root mean square difference when the first sample of the motion lies at `at_s` and it runs at a pace, rad; `None` where
/// too few samples overlap.
fn left_rad(
    pairs: &[(&Track, &Track)],
    [from_s, to_s]: [f64; 2],
    (at_s, pace): (f64, f64),
    instants: usize,
    covered: f64,
) -> Option<f64> {
    let (mut sum, mut seen) = (0.0, 0_usize);
    for (motion, within) in pairs {
        let mut cursors = (0, 0);
        for k in 0..instants {
            let t_s = (to_s - from_s) * k as f64 / (instants - 1) as f64;
            let wanted = motion.at_after(&mut cursors.0, from_s + t_s);
            let there = within.at_after(&mut cursors.1, at_s + pace * t_s);
            if let (Some(wanted), Some(there)) = (wanted, there) {
                sum += (wanted.position - there.position).powi(2);
                seen += 1;
            }
        }
    }
    (seen as f64 >= covered * (instants * pairs.len()) as f64 - 1.0).then(|| (sum / seen as f64).sqrt())
}

/// Root mean square of the motion about its mean, joint by joint, rad.
fn spread_rad(pairs: &[(&Track, &Track)], from_s: f64, to_s: f64) -> f64 {
    let mut sum = 0.0;
    for (motion, _) in pairs {
        let at = |k: usize| motion.held_at(from_s + (to_s - from_s) * k as f64 / INSTANTS as f64).position;
        let mean = (0..INSTANTS).map(at).sum::<f64>() / INSTANTS as f64;
        sum += (0..INSTANTS).map(|k| (at(k) - mean).powi(2)).sum::<f64>();
    }
    (sum / (INSTANTS * pairs.len().max(1)) as f64).sqrt()
}

/// Where a function with one minimum is least, by golden sections.
fn least(value: &impl Fn(f64) -> Option<f64>, mut low: f64, mut high: f64) -> f64 {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let of = |at: f64| value(at).unwrap_or(f64::INFINITY);
    let mut inner = (high - GOLDEN * (high - low), low + GOLDEN * (high - low));
    let mut values = (of(inner.0), of(inner.1));
    for _ in 0..30 {
        if values.0 <= values.1 {
            high = inner.1;
            inner = (high - GOLDEN * (high - low), inner.0);
            values = (of(inner.0), values.0);
        } else {
            low = inner.0;
            inner = (inner.1, low + GOLDEN * (high - low));
            values = (values.1, of(inner.1));
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two joints that stand, stroke and stand again, from time 5 s of their own on.
    fn motion() -> Series {
        let t_s: Vec<f64> = (0..=1000).map(|k| 5.0 + f64::from(k) * 0.01).collect();
        let stroke = |t: f64, scale: f64| scale * (0.4 * (t - 7.0).clamp(0.0, 5.0)).sin().powi(2);
        let track = |name: &str, scale: f64| {
            let angles = t_s.iter().map(|t| stroke(*t, scale)).collect();
            Track::new(name, t_s.clone(), angles, &[]).unwrap()
        };
        Series { tracks: vec![track("a", 0.5), track("b", -0.3)] }
    }

    /// The motion begun at some times, sampled at 45 Hz with a ripple, at rest between.
    fn within(starts_s: &[f64], end_s: f64) -> Series {
        let motion = motion();
        let t_s: Vec<f64> = (0..9000).map(|k| f64::from(k) / 45.0).filter(|t| *t < end_s).collect();
        let tracks = motion.tracks.iter().map(|track| {
            let angle = |(k, t): (usize, &f64)| {
                let start = starts_s.iter().copied().filter(|s| s <= t).fold(f64::NEG_INFINITY, f64::max);
                let own = if start.is_finite() { 5.0 + t - start } else { 5.0 };
                track.held_at(own.min(15.0)).position + 1e-4 * ((k * 7919) % 11) as f64
            };
            Track::new(track.name(), t_s.clone(), t_s.iter().enumerate().map(angle).collect(), &[]).unwrap()
        });
        Series { tracks: tracks.collect() }
    }

    #[test]
    fn a_motion_is_found_to_a_millisecond_between_samples_twenty_times_as_far_apart() {
        for start_s in [31.2345, 0.5, 88.0] {
            let found = locate(&motion(), &within(&[start_s], 100.0)).unwrap();
            assert!((found.at_s - (start_s - 5.0)).abs() < 1e-3, "{start_s}: {found:?}");
            assert!(found.rms_rad < 0.01 * found.spread_rad && found.others == 0 && found.joints == 2);
        }
    }

    #[test]
    fn of_three_runs_the_first_is_taken_and_the_others_are_counted() {
        let found = locate(&motion(), &within(&[12.0, 30.0, 55.5], 80.0)).unwrap();
        assert!((found.at_s - 7.0).abs() < 1e-3 && found.others == 2, "{found:?}");
    }

    #[test]
    fn a_clock_that_runs_apart_is_told_from_one_that_does_not() {
        for pace in [1.0, 1.02, 0.98] {
            let mut log = within(&[31.2345], 100.0);
            for track in &mut log.tracks {
                let t_s: Vec<f64> = track.t_s().iter().map(|t| 31.2345 + pace * (t - 31.2345)).collect();
                *track = Track::new(track.name(), t_s, track.position().to_vec(), &[]).unwrap();
            }
            let found = locate(&motion(), &log).unwrap();
            assert!((found.pace.unwrap_or(1.0) - pace).abs() < 1e-3, "{pace}: {found:?}");
            assert!(found.rms_rad < 0.01 * found.spread_rad, "{pace}: {found:?}");
        }
    }

    #[test]
    fn another_motion_leaves_as_much_as_there_is() {
        let mut other = within(&[20.0], 60.0);
        for track in &mut other.tracks {
            let angles = track.position().iter().map(|q| 0.8 - 2.0 * q).collect();
            *track = Track::new(track.name(), track.t_s().to_vec(), angles, &[]).unwrap();
        }
        let found = locate(&motion(), &other).unwrap();
        assert!(found.rms_rad > found.spread_rad, "{found:?}");
    }

    #[test]
    fn a_run_that_was_stopped_or_recorded_late_holds_a_part() {
        let stopped = locate(&motion(), &within(&[20.0], 25.0)).unwrap();
        assert!((stopped.at_s - 15.0).abs() < 2e-3 && (stopped.covered - 0.5).abs() < 0.01, "{stopped:?}");
        let late = within(&[20.0], 60.0).tracks;
        let from = |track: Track| {
            let first = track.t_s().partition_point(|t| *t < 23.5);
            Track::new(track.name(), track.t_s()[first..].to_vec(), track.position()[first..].to_vec(), &[])
        };
        let late = Series { tracks: late.into_iter().map(|track| from(track).unwrap()).collect() };
        let found = locate(&motion(), &late).unwrap();
        assert!((found.at_s - 15.0).abs() < 2e-3 && (found.covered - 0.65).abs() < 0.01, "{found:?}");
    }

    #[test]
    fn rest_alone_other_joints_and_a_log_too_short_are_nowhere() {
        let rest = Track::new("a", vec![0.0, 1.0, 2.0], vec![0.3; 3], &[]).unwrap();
        assert_eq!(locate(&Series { tracks: vec![rest] }, &within(&[1.0], 20.0)), None);
        let other = Track::new("z", vec![0.0, 1.0], vec![0.0, 1.0], &[]).unwrap();
        assert_eq!(locate(&motion(), &Series { tracks: vec![other] }), None);
        assert_eq!(locate(&motion(), &within(&[0.0], 2.5)), None);
        let endless = Track::new("a", vec![0.0, 1e12], vec![0.0, 1.0], &[]).unwrap();
        assert_eq!(locate(&motion(), &Series { tracks: vec![endless] }), None);
    }
}
