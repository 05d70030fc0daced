//! When a plan begins in a log that may hold it, and what the log has of it.

use super::carried::rest::PLAN_LEAD_S;
use crate::{
    series::{Series, SignalError, Track, bridged, moving_s},
    units::DEGREE_RAD,
};

/// Plans whose angles differ by less are the same, rad, and a correction below this is none.
pub(super) const SAME_RAD: f64 = 1e-3;

/// The stamps of two records are so much apart, s, of either 10 ms early or late: angles may differ by what the plan moves in it.
const JITTER_S: f64 = 0.02;

/// Steps on either side over which jitter makes little of a speed.
const CALM: usize = 10;

/// By how much two records of one plan may differ where it has a speed, rad/s; rad.
pub(super) fn may_differ_rad(speed_rad_s: f64) -> f64 {
    SAME_RAD + JITTER_S * speed_rad_s.abs()
}

/// Rounds that bring a plan onto the clock of another at most, the longest step of one, and one that is none any more, s. A slow plan
/// creeps from its rest for seconds before it is seen to move.
const ROUNDS: usize = 40;
const MOST_AHEAD_S: f64 = 0.5;
const SETTLED_S: f64 = 1e-5;

/// A plan is broken off within this, s, where another one that is the same before goes on by so much, rad: a plan that ends there
/// has a ramp, and is another one from its begin on.
const BROKEN_OFF_S: f64 = 0.2;
const GOES_ON_RAD: f64 = 0.5 * DEGREE_RAD;

const ROUNDING_S: f64 = 1e-6;

/// When a plan, of which every joint starts at 0, begins in a log of it, s; `None` if the log holds another. `near_s` is known from
/// the first moving sample; the whole plan tells it better.
pub(super) fn found_at_s(plan: &Series, log: &Series, near_s: f64) -> Result<Option<f64>, SignalError> {
    let end_s = plan.span_s().map_or(0.0, |[_, end_s]| end_s);
    let mut starts_s = near_s;
    let mut planned = cut(log, starts_s, starts_s + end_s)?;
    for _ in 0..ROUNDS {
        let ahead_s = ahead_s(&planned, plan).clamp(-MOST_AHEAD_S, MOST_AHEAD_S);
        starts_s -= ahead_s;
        planned = cut(log, starts_s, starts_s + end_s)?;
        if ahead_s.abs() < SETTLED_S {
            break;
        }
    }
    let same = planned.tracks.len() == plan.tracks.len() && alike(&planned, plan);
    Ok(same.then_some(starts_s))
}

/// Whether a log holds the plan of another one.
pub(super) fn is_again(log: &Series, plan: &Series) -> bool {
    let found = || {
        let ([from_s, to_s], [near_s, _]) = (moving_s(plan)?, moving_s(log)?);
        let own = cut(&*bridged(plan).ok()?, from_s - PLAN_LEAD_S, to_s).ok()?;
        found_at_s(&own, &*bridged(log).ok()?, near_s - PLAN_LEAD_S).ok()?
    };
    found().is_some()
}

/// How long after its first motion a plan ends in the middle of that of another one that it begins like, s: the run was broken off.
/// The last [`BROKEN_OFF_S`] of it may differ.
pub(super) fn breaks_off_after_s(plan: &Series, other: &Series) -> Result<Option<f64>, SignalError> {
    let (Some([from_s, to_s]), Some([near_s, _])) = (moving_s(plan), moving_s(other)) else {
        return Ok(None);
    };
    let begun = cut(plan, 0.0, (to_s - BROKEN_OFF_S).max(0.0))?;
    let Some(starts_s) = found_at_s(&begun, other, near_s - PLAN_LEAD_S)? else { return Ok(None) };
    let goes_on = other.tracks.iter().any(|track| {
        let [before, after] =
            [-BROKEN_OFF_S, BROKEN_OFF_S].map(|by_s| track.held_at(starts_s + to_s + by_s).position);
        (after - before).abs() > GOES_ON_RAD
    });
    Ok(goes_on.then_some(to_s - from_s))
}

/// How far one is ahead of a plan of equal samples, s: the shift of least squares.
pub(super) fn ahead_s(planned: &Series, plan: &Series) -> f64 {
    ahead(planned, plan).0
}

/// The same, with the share of the squares of what it is off by that this shift explains.
pub(super) fn ahead(planned: &Series, plan: &Series) -> (f64, f64) {
    let (mut along, mut square, mut off) = (0.0, 0.0, 0.0);
    for track in &plan.tracks {
        let Some(other) = planned.track(track.name()) else { continue };
        let steps = track.t_s().windows(2).zip(track.position().windows(2));
        for ((t_s, position), other) in steps.zip(other.position()) {
            let speed = (position[1] - position[0]) / (t_s[1] - t_s[0]);
            along += speed * (other - position[0]);
            square += speed * speed;
            off += (other - position[0]).powi(2);
        }
    }
    if square > 0.0 && off > 0.0 { (along / square, along * along / (square * off)) } else { (0.0, 0.0) }
}

/// Whether no angle differs by more than stamps do that are a little early or late.
fn alike(series: &Series, plan: &Series) -> bool {
    plan.tracks.iter().all(|plan| {
        let Some(track) = series.track(plan.name()).filter(|track| track.len() == plan.len()) else {
            return false;
        };
        let q_rad = plan.position();
        let speed_rad_s = |k: usize| {
            let (before, after) = (k.saturating_sub(CALM), (k + CALM).min(q_rad.len() - 1));
            (q_rad[after] - q_rad[before]) / ((after - before).max(1) as f64 * crate::fit::STEP_S)
        };
        let mut pairs = track.position().iter().zip(q_rad).enumerate();
        pairs.all(|(k, (a, b))| (a - b).abs() < may_differ_rad(speed_rad_s(k)))
    })
}

/// Whether two signals are of the same rows, nearly: a stamp that is late is late for both.
pub(super) fn of_same_rows(series: &Series, other: &Series) -> bool {
    let same = |track: &Track| {
        other.track(track.name()).is_some_and(|other| {
            let known = |t_s: &&f64| other.t_s().binary_search_by(|own_s| own_s.total_cmp(t_s)).is_ok();
            track.t_s().iter().filter(known).count() * 10 >= 9 * track.len()
        })
    };
    !series.tracks.is_empty() && series.tracks.iter().all(same)
}

/// What belongs to the plan of a log, by its rows, brought onto the plan that this is another record of: what it was off by stays
/// the same.
pub(super) fn onto(series: &Series, own: &Series, plan: &Series) -> Result<Series, SignalError> {
    let one = |track: &Track| {
        let Some((own, plan)) = own.track(track.name()).zip(plan.track(track.name())) else {
            return Ok(track.clone());
        };
        let by = |(t_s, position): (&f64, &f64)| {
            position + plan.held_at(*t_s).position - own.held_at(*t_s).position
        };
        let position = track.t_s().iter().zip(track.position()).map(by).collect();
        let cuts: Vec<usize> = track.segments().iter().skip(1).map(|segment| segment.start).collect();
        let made = Track::of(track.kind(), track.name(), track.t_s(), position, &cuts)?;
        match track.velocity() {
            Some(speed) => made.with_velocity(speed.to_vec()),
            None => Ok(made),
        }
    };
    Ok(Series { tracks: series.tracks.iter().map(one).collect::<Result<_, _>>()? })
}

/// Whether no angle differs by so much.
pub(super) fn within(series: &Series, plan: &Series, most_rad: f64) -> bool {
    plan.tracks.iter().all(|plan| {
        series.track(plan.name()).is_some_and(|track| {
            let pairs = track.position().iter().zip(plan.position());
            track.len() == plan.len() && pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) < most_rad
        })
    })
}

/// A stretch of a series every [`STEP_S`](crate::fit::STEP_S), its times counted from its start; beyond its ends joints rest.
pub(super) fn cut(series: &Series, from_s: f64, to_s: f64) -> Result<Series, SignalError> {
    let t_s = checked_grid(to_s - from_s)?;
    let one = |track: &Track| {
        let states: Vec<_> = t_s.iter().map(|t| track.held_at(t + from_s)).collect();
        let position = states.iter().map(|state| state.position).collect();
        let made = Track::of(track.kind(), track.name(), t_s.clone(), position, &[])?;
        match track.velocity() {
            Some(_) => made.with_velocity(states.iter().map(|state| state.velocity).collect()),
            None => Ok(made),
        }
    };
    Ok(Series { tracks: series.tracks.iter().map(one).collect::<Result<_, _>>()? })
}

/// The same where there are samples: what was not measured stays so. Joints of which nothing is left are left out.
pub(super) fn cut_measured(series: &Series, from_s: f64, to_s: f64) -> Result<Series, SignalError> {
    let t_s = checked_grid(to_s - from_s)?;
    let one = |track: &Track| {
        let (mut kept_s, mut position, mut cuts) = (Vec::new(), Vec::new(), Vec::new());
        for t in &t_s {
            let Some(state) = track.at(t + from_s) else { continue };
            if kept_s.last().is_some_and(|last| t - last > 1.5 * crate::fit::STEP_S) {
                cuts.push(kept_s.len());
            }
            kept_s.push(*t);
            position.push(state.position);
        }
        (!kept_s.is_empty()).then(|| Track::of(track.kind(), track.name(), kept_s, position, &cuts))
    };
    Ok(Series { tracks: series.tracks.iter().filter_map(one).collect::<Result<_, _>>()? })
}

/// No motion takes longer, s.
const MOST_S: f64 = 86_400.0;

fn checked_grid(span_s: f64) -> Result<Vec<f64>, SignalError> {
    if span_s > MOST_S {
        return Err(SignalError::TooLong { span_s, most_s: MOST_S });
    }
    Ok(grid(span_s))
}

/// A duration that is the difference of two instants is off by their rounding, and no step the longer for it.
pub(super) fn grid(duration_s: f64) -> Vec<f64> {
    let end_s = duration_s - ROUNDING_S;
    let mut t_s = vec![0.0];
    while let Some(last) = t_s.last().filter(|last| **last < end_s) {
        let next = (last / crate::fit::STEP_S).round() + 1.0;
        t_s.push(next * crate::fit::STEP_S);
    }
    t_s
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plan_that_stops_at_once_in_that_of_another_is_broken_off_and_a_shorter_move_is_none() {
        // Ramps of 0.4 s to 8 deg/s, from 2 s on.
        let plan = |cruise_s: f64, cut_s: f64| {
            let speed =
                |t_s: f64| (t_s / 0.4).min((cruise_s + 0.8 - t_s) / 0.4).clamp(0.0, 1.0) * 8.0 * DEGREE_RAD;
            let mut at_rad = 0.0;
            Series::sampled("J", 2000, |t| {
                at_rad += 0.01 * if t < cut_s { speed(t - 2.0) } else { 0.0 };
                at_rad
            })
        };
        let whole = plan(5.0, 20.0);
        let broken = |short: &Series| {
            let begun = cut(short, 2.0 - PLAN_LEAD_S, 18.0).unwrap();
            breaks_off_after_s(&begun, &whole).unwrap()
        };
        let after_s = broken(&plan(5.0, 5.0)).unwrap();
        assert!((after_s - 3.0).abs() < 0.1, "{after_s}");
        assert_eq!(broken(&plan(2.0, 20.0)), None, "a shorter move with the same ramps");
        assert_eq!(broken(&whole), None);
    }

    #[test]
    fn a_plan_recorded_between_the_samples_is_brought_onto_the_clock() {
        let wave = |shift_s: f64| Series::sampled("J", 2000, |t| 0.3 * (0.4 * (t + shift_s)).sin());
        for shift_s in [-0.2, -0.004, 0.0, 0.0071, 0.15] {
            let found = ahead_s(&wave(shift_s), &wave(0.0));
            assert!((found - shift_s).abs() < 0.01 * shift_s.abs() + 1e-4, "{shift_s} {found}");
        }
    }

    #[test]
    fn a_slow_plan_is_found_however_late_it_is_seen_to_move() {
        let sigmoid = |shift_s: f64, steps: u32| {
            Series::sampled("J", steps, |t| 0.8 * (0.5 + 0.5 * ((t - shift_s) / 12.0).tanh()))
        };
        let plan = sigmoid(30.0, 6000);
        for off_s in [-4.0, -1.6, -0.7, 0.0, 0.7, 1.6, 4.0] {
            let log = sigmoid(35.0, 7000);
            let found = found_at_s(&plan, &log, 5.0 + off_s).unwrap();
            assert!(found.is_some_and(|at_s| (at_s - 5.0).abs() < 1e-3), "{off_s} s: {found:?}");
        }
    }

    #[test]
    fn stamps_that_jitter_make_no_other_plan_and_hide_no_error() {
        // From rest to rest, sampled where the stamps say that it was not.
        let sigmoid = |stretch: f64, late_s: f64, off: f64| {
            let t_s: Vec<f64> = (0..3000).map(|k| f64::from(k) * 0.01).collect();
            let late = |k: usize| late_s * ((k * 7919 % 101) as f64 / 50.0 - 1.0);
            let at = |(k, t): (usize, &f64)| off + 0.8 * ((t + late(k) - 15.0) / stretch).tanh();
            let position = t_s.iter().enumerate().map(at).collect();
            Series { tracks: vec![Track::new("J", t_s, position, &[]).unwrap()] }
        };
        let plan = sigmoid(2.0, 0.0, 0.0);
        let found = |log: &Series| found_at_s(&plan, log, 0.0).unwrap();
        let jittered = sigmoid(2.0, 0.009, 0.0);
        assert!(!within(&jittered, &plan, SAME_RAD));
        assert!(found(&jittered).is_some_and(|at_s| at_s.abs() < 1e-3));
        let otherwise = sigmoid(2.0, -0.009, 0.0);
        assert!(found_at_s(&jittered, &otherwise, 0.0).unwrap().is_some(), "both jitter");
        assert_eq!(found(&sigmoid(2.05, 0.0, 0.0)), None);
        assert_eq!(found(&sigmoid(2.0, 0.05, 0.0)), None);
        let measured = sigmoid(2.0, 0.009, 0.02);
        assert!(of_same_rows(&measured, &jittered));
        let moved = onto(&measured, &jittered, &plan).unwrap();
        assert!(within(&moved, &sigmoid(2.0, 0.0, 0.02), 1e-9));
    }
}
