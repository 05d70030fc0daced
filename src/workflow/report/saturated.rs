//! Joints that go no faster than some speed, whatever their plan asks for.

use super::outcome::Report;
use crate::{
    replay::{JointReplay, Transition},
    series::{JointKind, Pair, local_quadratic},
};

/// A plan asks for more by this factor.
const ASKS: f64 = 1.15;
/// Samples within this share of the fastest are as fast, and motions whose fastest are within this factor reach the same.
const AS_FAST: f64 = 0.95;
const SAME: f64 = 1.08;
/// A joint is at its limit for so long in a motion, s, and for this share of the time in which it moves at all.
const LASTS_S: f64 = 0.3;
const SHARE: f64 = 0.4;
const MOVES: f64 = 0.2;
/// In so many motions at least.
const MOTIONS: usize = 2;

/// The speed that a joint does not pass.
#[derive(Debug, Clone, PartialEq)]
pub struct Saturated {
    /// The joint.
    pub joint: String,
    /// Whether it turns or slides.
    pub kind: JointKind,
    /// Which way: 1 for growing positions, -1 for falling ones.
    pub direction: i8,
    /// The speed, rad/s or m/s.
    pub speed: f64,
    /// The most that its plan asks for.
    pub asked: f64,
    /// Motions in which it was at that speed, and those whose plan asks for more.
    pub count: [usize; 2],
}

/// How fast a joint went in a motion: what was asked for, what it came to, and whether it stayed there.
struct Motion {
    asked: f64,
    fastest: f64,
    held: bool,
}

impl Report {
    /// The joints that do so, each way by itself: a cylinder is faster in one than in the other.
    pub fn saturated(&self) -> Vec<Saturated> {
        if !self.is_in_time() {
            return Vec::new();
        }
        self.replay.joints.iter().flat_map(|joint| self.saturated_joint(joint)).collect()
    }

    fn saturated_joint(&self, joint: &JointReplay) -> Vec<Saturated> {
        let Some(pair) = self.pairs.iter().find(|pair| pair.name == joint.name) else { return Vec::new() };
        // Most joints come to what their plan asks for.
        let asks_more =
            |way: &i8| fastest(pair, &pair.planned, *way) > ASKS * fastest(pair, &pair.measured, *way);
        let ways: Vec<i8> = [1, -1].into_iter().filter(asks_more).collect();
        if ways.is_empty() {
            return Vec::new();
        }
        let fits = local_quadratic(&pair.t_s, &pair.measured, &pair.segments, joint.thresholds.window_s, 3);
        let speeds: Vec<f64> = fits.into_iter().map(|fit| fit.velocity).collect();
        let starts: Vec<&Transition> =
            self.replay.transitions.iter().filter(|start| start.joint == joint.name).collect();
        let band = self.replay.rules.sizes(joint.kind).settle_band;
        let ends = starts.iter().skip(1).map(|start| start.planned_onset_s).chain([f64::INFINITY]);
        let motions: Vec<(i8, Motion)> = (starts.iter().zip(ends))
            .filter_map(|(start, end_s)| {
                Some((start.direction, motion(pair, &speeds, (start, end_s), band)?))
            })
            .collect();
        ways.into_iter().filter_map(|way| one_way(joint, way, &motions)).collect()
    }
}

/// The speed that no motion one way passes, if some stay at it.
fn one_way(joint: &JointReplay, direction: i8, motions: &[(i8, Motion)]) -> Option<Saturated> {
    let own = || motions.iter().filter(|(way, _)| *way == direction).map(|(_, motion)| motion);
    let held = || own().filter(|motion| motion.held);
    let fastest = held().map(|motion| motion.fastest);
    let (low, high) = fastest.fold((f64::INFINITY, 0.0_f64), |(low, high), x| (low.min(x), high.max(x)));
    let asks_more = own().filter(|motion| motion.asked > ASKS * high).count();
    let one_speed = high < SAME * low && own().all(|motion| motion.fastest < SAME * high);
    (held().count() >= MOTIONS && one_speed && 2 * held().count() > asks_more).then(|| Saturated {
        joint: joint.name.clone(),
        kind: joint.kind,
        direction,
        speed: high,
        asked: held().map(|motion| motion.asked).fold(0.0, f64::max),
        count: [held().count(), asks_more],
    })
}

/// About the largest speed one way, as it shows over so long, s.
fn fastest(pair: &Pair, q: &[f64], way: i8) -> f64 {
    const OVER_S: f64 = 0.2;
    let (mut from, mut most) = (0, 0.0_f64);
    for k in 0..q.len() {
        while from + 1 < k && pair.t_s[k] - pair.t_s[from + 1] >= OVER_S {
            from += 1;
        }
        let span_s = pair.t_s[k] - pair.t_s[from];
        if span_s >= OVER_S {
            most = most.max(f64::from(way) * (q[k] - q[from]) / span_s);
        }
    }
    most
}

fn planned(pair: &Pair, k: usize) -> f64 {
    match &pair.planned_velocity {
        Some(velocity) => velocity[k],
        None if k + 1 < pair.t_s.len() => {
            (pair.planned[k + 1] - pair.planned[k]) / (pair.t_s[k + 1] - pair.t_s[k]).max(1e-6)
        }
        None => 0.0,
    }
}

/// Of the motion that a start begins, until the next one; `None` of one that has no samples.
fn motion(pair: &Pair, speeds: &[f64], (start, end_s): (&Transition, f64), band: f64) -> Option<Motion> {
    let along = f64::from(start.direction);
    let at = |s: f64| pair.t_s.partition_point(|t_s| *t_s < s);
    let samples = at(start.planned_onset_s)..at(end_s);
    let step_s =
        |k: usize| if k + 1 < pair.t_s.len() { (pair.t_s[k + 1] - pair.t_s[k]).min(LASTS_S) } else { 0.0 };
    let mut reached: Vec<f64> = samples.clone().map(|k| along * speeds[k]).collect();
    // A few samples of noise are not what it came to.
    let place = reached.len() - reached.len() / 50 - 1.min(reached.len());
    let fastest =
        *reached.get_mut(..).filter(|all| !all.is_empty())?.select_nth_unstable_by(place, f64::total_cmp).1;
    let behind = |k: &usize| along * (pair.planned[*k] - pair.measured[*k]) > band;
    let lasts_s = |least: f64| -> f64 {
        samples.clone().filter(behind).filter(|k| along * speeds[*k] > least * fastest).map(step_s).sum()
    };
    let asked = samples.clone().map(|k| along * planned(pair, k)).fold(0.0, f64::max);
    let at_limit_s = lasts_s(AS_FAST);
    // A plan that is drawn through few values has speeds of its own, but takes no longer for that.
    let [own_s, planned_s] =
        [&pair.measured, &pair.planned].map(|q| takes_s(&pair.t_s, q, samples.clone(), along));
    let longer = own_s.zip(planned_s).is_some_and(|(own_s, planned_s)| own_s > ASKS * planned_s);
    let held = longer
        && asked > ASKS * fastest
        && fastest > 0.0
        && at_limit_s > LASTS_S
        && at_limit_s > SHARE * lasts_s(MOVES);
    Some(Motion { asked, fastest, held })
}

/// How long a motion takes for all but the first and the last tenth of its way, s.
fn takes_s(t_s: &[f64], q: &[f64], samples: std::ops::Range<usize>, along: f64) -> Option<f64> {
    let own = samples.clone().map(|k| along * q[k]);
    let (low, high) =
        own.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
    let at = |share: f64| {
        let place = low + share * (high - low);
        samples.clone().find(|k| along * q[*k] >= place).map(|k| t_s[k])
    };
    Some(at(0.9)? - at(0.1)?)
}

#[cfg(test)]
mod tests {
    use std::fmt::Write as _;

    use super::*;
    use crate::workflow::report::{Inputs, run};

    /// A report of strokes at 10 deg/s, answered 0.1 s later, at most so fast up and down, deg/s.
    fn report([up, down]: [f64; 2]) -> Report {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.csv");
        let (mut table, mut came) = ("t_s,j1_planned_deg,j1_measured_deg\n".to_owned(), 0.0_f64);
        let plan = |t_s: f64| {
            let step = |from_s: f64| ((t_s - from_s) / 3.0).clamp(0.0, 1.0);
            30.0 * (step(2.0) - step(12.0) + step(22.0) - step(32.0))
        };
        for k in 0..4200 {
            let t_s = 0.01 * f64::from(k);
            came += (plan(t_s - 0.1) - came).clamp(-0.01 * down, 0.01 * up);
            writeln!(table, "{t_s:.2},{:.5},{came:.5}", plan(t_s)).unwrap();
        }
        std::fs::write(&path, table).unwrap();
        run(&Inputs { logs: vec![path], ..Inputs::default() }).unwrap()
    }

    #[test]
    fn a_joint_at_its_limit_is_told_each_way_and_one_that_lags_is_not() {
        let told = |limits: [f64; 2]| -> Vec<(i8, f64, [usize; 2])> {
            let degrees = |speed: f64| (speed / crate::units::DEGREE_RAD * 10.0).round() / 10.0;
            let found = report(limits).saturated();
            found.iter().map(|one| (one.direction, degrees(one.speed), one.count)).collect()
        };
        let near = |found: &[(i8, f64, [usize; 2])], expected: &[(i8, f64)]| {
            assert_eq!(found.len(), expected.len(), "{found:?}");
            for ((way, speed, count), (of, limit)) in found.iter().zip(expected) {
                assert!(way == of && (speed - limit).abs() < 0.2 && *count == [2, 2], "{found:?}");
            }
        };
        near(&told([6.0, 6.0]), &[(1, 6.0), (-1, 6.0)]);
        near(&told([7.0, 4.0]), &[(1, 7.0), (-1, 4.0)]);
        near(&told([100.0, 5.0]), &[(-1, 5.0)]);
        near(&told([100.0, 100.0]), &[]);
    }
}
