//! A joint that something holds: it comes to one place and no farther, whatever is sent.

use serde::{Deserialize, Serialize};

use super::answer::Answer;
use crate::units::DEGREE_RAD;

/// How long a joint stands there at least, s.
const STANDS_S: f64 = 0.3;

/// How far the plan goes on, and by how much more one run was sent beyond it than another, rad, at least: without that, nobody knows.
const BEYOND_RAD: f64 = 0.2 * DEGREE_RAD;
const PUSHED_RAD: f64 = 0.3 * DEGREE_RAD;

/// How much farther it comes at most, by how much more it was pushed and beside the noise, rad.
const YIELDS: f64 = 0.05;
const NOISE_RAD: f64 = 0.03 * DEGREE_RAD;

/// Where a joint is held: of its plan, nothing beyond is learnt. Of one that slides a radian stands for a metre.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Stop {
    /// The place, rad.
    pub at_rad: f64,
    /// 1 for the upper end of its motion, -1 for the lower one.
    pub side: f64,
    /// How far the plan goes beyond, rad.
    pub beyond_rad: f64,
}

impl Stop {
    /// By runs of a plan; of two, that of which the plan goes on farther.
    pub(super) fn of(planned: &[(f64, f64)], answers: &[Answer]) -> Option<Self> {
        let stops = [1.0, -1.0].into_iter().filter_map(|side| at_end(planned, answers, side));
        stops.max_by(|a, b| a.beyond_rad.total_cmp(&b.beyond_rad))
    }

    /// Whether the plan is beyond it at a place.
    pub fn is_before(&self, planned_rad: f64) -> bool {
        self.side * (planned_rad - self.at_rad) > 0.0
    }

    /// Takes away what a run teaches of where the plan is beyond it.
    pub(super) fn unlearnt(&self, run: &mut Answer, planned: &[(f64, f64)]) {
        for (seen, planned) in run.seen.iter_mut().zip(planned) {
            *seen &= !self.is_before(planned.0 + run.shifted_rad);
        }
        run.fill(planned);
    }

    /// Takes away what a correction pushes against it; the largest part of that, rad.
    pub(super) fn relieved(&self, correction_rad: &mut [f64], planned: &[(f64, f64)]) -> f64 {
        let mut most_rad = 0.0_f64;
        for (correction, planned) in correction_rad.iter_mut().zip(planned) {
            if self.is_before(planned.0) {
                let relieved = self.side * (self.side * *correction).min(0.0);
                most_rad = most_rad.max((*correction - relieved).abs());
                *correction = relieved;
            }
        }
        most_rad
    }
}

fn at_end(planned: &[(f64, f64)], answers: &[Answer], side: f64) -> Option<Stop> {
    let (mut came, mut pushed) = ([f64::INFINITY, f64::NEG_INFINITY], [f64::INFINITY, f64::NEG_INFINITY]);
    for run in answers {
        let stands = farthest(run.measured_rad.iter().map(|angle| side * angle))?;
        // What is sent before it is there pushes nothing.
        let there =
            run.sent.iter().zip(&run.measured_rad).filter(|(_, angle)| side * **angle > stands - NOISE_RAD);
        let sent = farthest(there.map(|(sent, _)| side * sent.0)).unwrap_or(stands);
        for (range, now) in [(&mut came, stands), (&mut pushed, sent)] {
            *range = [range[0].min(now), range[1].max(now)];
        }
    }
    let more_rad = pushed[1] - pushed[0];
    let beyond_rad = farthest(planned.iter().map(|planned| side * planned.0))? - came[1];
    let held = came[1] - came[0] <= YIELDS * more_rad + NOISE_RAD;
    (more_rad > PUSHED_RAD && beyond_rad > BEYOND_RAD && pushed[0] - came[1] > BEYOND_RAD && held)
        .then_some(Stop { at_rad: side * came[1], side, beyond_rad })
}

/// What values are beyond for [`STANDS_S`] in all.
fn farthest(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.collect();
    let place = values.len().checked_sub(super::super::model::steps_in(STANDS_S))?;
    (place < values.len()).then(|| *values.select_nth_unstable_by(place, f64::total_cmp).1)
}

#[cfg(test)]
mod tests {
    use super::{super::super::model::STEP_S, *};

    /// Out by 40 deg, a rest of 3 s, and back.
    fn planned() -> Vec<(f64, f64)> {
        let at = |t_s: f64| {
            let step = |from_s: f64| {
                let x = ((t_s - from_s) / 4.0).clamp(0.0, 1.0);
                x * x * (3.0 - 2.0 * x)
            };
            40.0 * DEGREE_RAD * (step(2.0) - step(9.0))
        };
        let count = super::super::super::model::steps_in(15.0);
        (0..count).map(|k| (at(k as f64 * STEP_S), 0.0)).collect()
    }

    fn found(pushed_deg: [f64; 2], held: impl Fn(f64, f64) -> f64, side: f64) -> Option<Stop> {
        let planned: Vec<(f64, f64)> = planned().iter().map(|planned| (side * planned.0, 0.0)).collect();
        let answers = pushed_deg.map(|by_deg| {
            let sent: Vec<(f64, f64)> =
                planned.iter().map(|planned| (planned.0 * (1.0 + by_deg / 40.0), 0.0)).collect();
            let measured_rad =
                sent.iter().map(|sent| side * held(side * sent.0 / DEGREE_RAD, by_deg) * DEGREE_RAD);
            Answer { measured_rad: measured_rad.collect(), sent, ..Answer::default() }
        });
        Stop::of(&planned, &answers)
    }

    #[test]
    fn a_joint_that_comes_no_farther_however_far_it_is_sent_is_held() {
        for side in [1.0, -1.0] {
            let stop = found([0.0, 2.0], |sent, _| sent.min(38.5), side).unwrap();
            assert!(
                (stop.at_rad / DEGREE_RAD - side * 38.5).abs() < 1e-6 && stop.side * side > 0.0,
                "{stop:?}"
            );
            assert!(
                (stop.beyond_rad / DEGREE_RAD - 1.5).abs() < 0.01 && stop.is_before(side * 0.69),
                "{stop:?}"
            );
        }
    }

    #[test]
    fn one_that_was_pushed_only_before_it_came_is_not() {
        // A pump that joints share: it creeps to within its dead band, and what is sent has come back to the plan by then.
        let planned = planned();
        let answers = [0.0, 3.0].map(|by_deg| {
            let early = |k: usize| if (250..450).contains(&k) { by_deg * DEGREE_RAD } else { 0.0 };
            let sent: Vec<(f64, f64)> =
                planned.iter().enumerate().map(|(k, at)| (at.0 + early(k), 0.0)).collect();
            let late = |k: usize| planned[k.saturating_sub(120)].0.min(39.7 * DEGREE_RAD);
            Answer { measured_rad: (0..planned.len()).map(late).collect(), sent, ..Answer::default() }
        });
        assert_eq!(Stop::of(&planned, &answers), None);
    }

    #[test]
    fn one_that_gives_way_arrives_or_was_not_pushed_is_not() {
        assert_eq!(found([0.0, 2.0], |sent, _| 0.96 * sent, 1.0), None, "it comes farther");
        assert_eq!(found([0.0, 2.0], |sent, _| sent.min(39.9), 1.0), None, "it arrives");
        assert_eq!(found([0.0, 0.2], |sent, _| sent.min(38.5), 1.0), None, "nobody knows");
        assert_eq!(found([0.0, 2.0], |sent, by| sent.min(38.5 + 0.2 * by), 1.0), None, "by a tenth");
    }
}
