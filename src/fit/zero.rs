//! The zero that a joint was measured from: where it is another than that of its plan, the joint is off by as much at every rest, and no
//! loop sees that.

use std::ops::Range;

use super::model::{STEP_S, steps_in};
use crate::{math::mean, units::DEGREE_RAD};

/// Planned speed that is motion, rad/s.
const MOVES_RAD_S: f64 = 1e-3;

/// A joint that rests this far from its plan before its first motion, and as far after its last one, was measured from
/// another zero, or its load holds it off, rad: no correction that ends where the plan ends mends that.
const SHIFTED_RAD: f64 = DEGREE_RAD;

/// The two rests agree within this share.
const SHIFTED_ALIKE: f64 = 0.2;

/// The same in the mean of all rests, some of which were reached from below and some from above: a dead band leaves a joint now on one
/// side of its plan and now on the other. They agree within this share where they are three, and where they are more.
const ALL_SHIFTED_RAD: f64 = 0.3 * DEGREE_RAD;
const ALL_ALIKE: [f64; 2] = [0.35, 0.6];

/// Rest that is looked at on either side, s, and how much of it must have been measured.
const AT_REST_S: f64 = 0.5;
const LEAST_AT_REST_S: f64 = 0.2;

/// What a joint was off by at rest, before and after all motion and in between alike, rad; 0 where it was not. Of each step of a plan it
/// is given what was measured less what was planned, where anything was.
pub(super) fn shift_rad(planned: &[(f64, f64)], measured_off_rad: impl Fn(usize) -> Option<f64>) -> f64 {
    let off_rad = |rest: &Range<usize>| {
        let last = rest.end.saturating_sub(steps_in(AT_REST_S)).max(rest.start)..rest.end;
        let seen: Vec<f64> = last.filter_map(&measured_off_rad).collect();
        (seen.len() >= steps_in(LEAST_AT_REST_S)).then(|| mean(&seen))
    };
    let rests = rests(planned);
    let (Some(first), Some(last)) = (rests.first(), rests.last().filter(|_| rests.len() > 1)) else {
        return 0.0;
    };
    let Some([before, after]) = off_rad(first).zip(off_rad(last)).map(<[f64; 2]>::from) else { return 0.0 };
    let ends_rad = mean(&[before, after]);
    if ends_rad.abs() > SHIFTED_RAD && (before - after).abs() < SHIFTED_ALIKE * ends_rad.abs() {
        return ends_rad;
    }
    let reached = |way: f64| {
        let mut pairs = rests.windows(2).filter(|two| off_rad(&two[1]).is_some());
        pairs.any(|two| way * (planned[two[1].start].0 - planned[two[0].start].0) > 0.0)
    };
    let all_rad: Vec<f64> = rests.iter().filter_map(off_rad).collect();
    let mean_rad = mean(&all_rad);
    let alike = ALL_ALIKE[usize::from(all_rad.len() > 3)] * mean_rad.abs();
    let far = mean_rad.abs() > ALL_SHIFTED_RAD && all_rad.len() > 2;
    let both_ways = far && reached(1.0) && reached(-1.0);
    if both_ways && all_rad.iter().all(|off| (off - mean_rad).abs() < alike) { mean_rad } else { 0.0 }
}

/// Where a plan rests: at its beginning and at its end, however shortly, and in between for long enough to tell.
pub(super) fn rests(planned: &[(f64, f64)]) -> Vec<Range<usize>> {
    let (mut rests, mut from) = (Vec::new(), 0);
    let n = planned.len();
    while from < n {
        let end = (from..n).find(|&k| moves(planned, k)).unwrap_or(n);
        if from == 0 || end == n || end - from >= steps_in(AT_REST_S) {
            rests.push(from..end);
        }
        from = (end..n).find(|&k| !moves(planned, k)).unwrap_or(n);
    }
    rests
}

/// Whether a plan moves from a step to the next.
pub(super) fn moves(planned: &[(f64, f64)], k: usize) -> bool {
    planned.get(k + 1).is_some_and(|next| (next.0 - planned[k].0).abs() > MOVES_RAD_S * STEP_S)
}
