//! Joints that go no faster than some speed, whatever their plan asks for.

use super::outcome::Report;
use crate::{
    remark::Code,
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
    /// The speed, rad/s or m/s, and the most that its plan asks for.
    pub speed: f64,
    /// The same of the plan.
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
    /// The joints that do so; none of a run at another time than its plan's, which is slower in all it does.
    pub fn saturated(&self) -> Vec<Saturated> {
        let others = [Code::OtherTime, Code::Stopped, Code::Paused];
        if self.remarks.as_slice().iter().any(|remark| others.contains(&remark.code)) {
            return Vec::new();
        }
        self.replay.joints.iter().filter_map(|joint| self.saturated_joint(joint)).collect()
    }

    fn saturated_joint(&self, joint: &JointReplay) -> Option<Saturated> {
        let pair = self.pairs.iter().find(|pair| pair.name == joint.name)?;
        let top = joint.peak_speed?;
        // Most joints come to what their plan asks for.
        if fastest_planned(pair) < ASKS * top {
            return None;
        }
        let fits = local_quadratic(&pair.t_s, &pair.measured, &pair.segments, joint.thresholds.window_s, 3);
        let speeds: Vec<f64> = fits.into_iter().map(|fit| fit.velocity).collect();
        let starts: Vec<&Transition> =
            self.replay.transitions.iter().filter(|start| start.joint == joint.name).collect();
        let band = self.replay.rules.sizes(joint.kind).settle_band;
        let ends = starts.iter().skip(1).map(|start| start.planned_onset_s).chain([f64::INFINITY]);
        let motions: Vec<Motion> = starts
            .iter()
            .zip(ends)
            .filter_map(|(start, end_s)| motion(pair, &speeds, (start, end_s), band))
            .collect();
        let held = || motions.iter().filter(|motion| motion.held);
        let fastest = held().map(|motion| motion.fastest);
        let (low, high) = fastest.fold((f64::INFINITY, 0.0_f64), |(low, high), x| (low.min(x), high.max(x)));
        let asks_more = motions.iter().filter(|motion| motion.asked > ASKS * high).count();
        let one_speed = high < SAME * low && motions.iter().all(|motion| motion.fastest < SAME * high);
        (held().count() >= MOTIONS && one_speed && 2 * held().count() > asks_more).then(|| Saturated {
            joint: joint.name.clone(),
            kind: joint.kind,
            speed: high,
            asked: held().map(|motion| motion.asked).fold(0.0, f64::max),
            count: [held().count(), asks_more],
        })
    }
}

/// The largest planned speed, by the plan's own speeds where it has them.
fn fastest_planned(pair: &Pair) -> f64 {
    (0..pair.t_s.len().saturating_sub(1)).map(|k| planned(pair, k).abs()).fold(0.0, f64::max)
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

    /// A report of strokes at 10 deg/s, answered 0.1 s later at most so fast, deg/s.
    fn report(fastest: f64) -> Report {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.csv");
        let (mut table, mut came) = ("t_s,j1_planned_deg,j1_measured_deg\n".to_owned(), 0.0_f64);
        let plan = |t_s: f64| {
            let step = |from_s: f64| ((t_s - from_s) / 3.0).clamp(0.0, 1.0);
            30.0 * (step(2.0) - step(12.0) + step(22.0) - step(32.0))
        };
        for k in 0..4200 {
            let t_s = 0.01 * f64::from(k);
            came += (plan(t_s - 0.1) - came).clamp(-0.01 * fastest, 0.01 * fastest);
            writeln!(table, "{t_s:.2},{:.5},{came:.5}", plan(t_s)).unwrap();
        }
        std::fs::write(&path, table).unwrap();
        run(&Inputs { logs: vec![path], ..Inputs::default() }).unwrap()
    }

    #[test]
    fn a_joint_at_its_limit_is_told_and_one_that_lags_is_not() {
        let found = report(6.0).saturated();
        let [one] = found.as_slice() else { panic!("{found:?}") };
        let degrees = |speed: f64| speed / crate::units::DEGREE_RAD;
        assert!((degrees(one.speed) - 6.0).abs() < 0.2 && (degrees(one.asked) - 10.0).abs() < 0.2, "{one:?}");
        assert_eq!((one.count, one.joint.as_str()), ([4, 4], "j1"));
        assert_eq!(report(100.0).saturated(), []);
    }
}
