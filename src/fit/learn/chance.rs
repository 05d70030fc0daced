//! What one motion of one run shows, and neither the model nor the other motions nor another run: an interlock that came late, a
//! load that stuck. It is not learnt until it comes again.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::{
    super::model::{Model, STEP_S, steps_in},
    answer::{Answer, motions},
    correct::{Workspace, largest, unexplained_rad},
};
use crate::{
    math::{lowpass, rms, smooth_step},
    units::DEGREE_RAD,
};

/// What a motion leaves unexplained is looked at below this, Hz.
const BELOW_HZ: f64 = 1.5;

/// It is by chance where it is more than that of every other motion times these, by itself and by the planned speed, and its top is
/// above this, rad.
const BEYOND: [f64; 2] = [2.5, 1.7];
const LEAST_RAD: f64 = 0.5 * DEGREE_RAD;

/// Motions of a joint that tell what is usual.
const LEAST_OTHERS: usize = 2;

/// It comes again in another run where the product of the two is this share of that of their sizes, and it is this share of it.
const ALIKE: f64 = 0.7;
const AS_LARGE: f64 = 0.4;

/// Over which what is left out fades, s.
const FADES_S: f64 = 0.3;

/// What came by chance in the newest run. Of a joint that slides a radian stands for a metre.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Chance {
    /// When the motion begins, from the plan's first sample, s.
    pub from_s: f64,
    /// When the next one does, or the plan ends, s.
    #[serde(default)]
    pub to_s: f64,
    /// What the model did not explain in it, at most, rad.
    pub peak_rad: f64,
    /// The same of the joint's other motions, rad.
    pub usual_rad: f64,
}

/// A motion, and what of it is unexplained in a run.
struct Motion {
    steps: Range<usize>,
    fastest_rad_s: f64,
    rms_rad: f64,
    peak_rad: f64,
}

/// Takes out of each run what came in it by chance, and tells what that was in the newest one.
pub(super) fn unlearnt(
    answers: &mut [Answer],
    planned: &[(f64, f64)],
    model: &Model,
    workspace: &mut Workspace,
) -> Option<Chance> {
    let left = |run: &Answer| {
        let mut left_rad = unexplained_rad(run, model, workspace);
        lowpass(&mut left_rad, BELOW_HZ, STEP_S);
        left_rad
    };
    let left: Vec<Vec<f64>> = answers.iter().map(left).collect();
    let mut told = None;
    for (k, run) in answers.iter_mut().enumerate() {
        let Some((steps, chance, keeps)) = in_run(&left, k, planned) else { continue };
        let over = FADES_S / STEP_S;
        for step in steps.clone() {
            let [since, until] =
                [step - steps.start, steps.end - 1 - step].map(|steps| smooth_step(steps as f64 / over));
            run.measured_rad[step] -= (1.0 - keeps) * since * until * left[k][step];
        }
        told = (k + 1 == left.len()).then_some(chance);
    }
    told
}

/// The motion of a run that is beyond all others, and the share of what is unexplained in it that is usual.
fn in_run(left: &[Vec<f64>], k: usize, planned: &[(f64, f64)]) -> Option<(Range<usize>, Chance, f64)> {
    let motions = of_motions(&left[k], planned);
    let worst = motions.iter().max_by(|a, b| a.rms_rad.total_cmp(&b.rms_rad))?;
    let others = || motions.iter().filter(|motion| motion.steps != worst.steps);
    let beyond =
        |times: f64, size: &dyn Fn(&Motion) -> f64| others().all(|other| size(worst) > times * size(other));
    let chance = others().count() >= LEAST_OTHERS
        && worst.peak_rad > LEAST_RAD
        && beyond(BEYOND[0], &|motion| motion.rms_rad)
        && beyond(BEYOND[1], &|motion| motion.rms_rad / motion.fastest_rad_s);
    let own = &left[k][worst.steps.clone()];
    let again = |other: &Vec<f64>| {
        let other = &other[worst.steps.clone()];
        let product = own.iter().zip(other).map(|(a, b)| a * b).sum::<f64>() / own.len() as f64;
        product > ALIKE * rms(own) * rms(other) && rms(other) > AS_LARGE * rms(own)
    };
    if !chance || left.iter().enumerate().any(|(other, left)| other != k && again(left)) {
        return None;
    }
    let usual = |size: &dyn Fn(&Motion) -> f64| others().map(size).fold(0.0, f64::max);
    let made = Chance {
        from_s: worst.steps.start as f64 * STEP_S,
        to_s: worst.steps.end as f64 * STEP_S,
        peak_rad: worst.peak_rad,
        usual_rad: usual(&|motion| motion.peak_rad),
    };
    Some((worst.steps.clone(), made, usual(&|motion| motion.rms_rad) / worst.rms_rad))
}

/// The motions of a plan, each without the fade before the next.
fn of_motions(left_rad: &[f64], planned: &[(f64, f64)]) -> Vec<Motion> {
    let motion = |steps: Range<usize>| {
        let ends = if steps.end < planned.len() {
            steps.end - steps_in(FADES_S).min(steps.len())
        } else {
            steps.end
        };
        let steps = steps.start..ends.min(left_rad.len());
        let own = left_rad.get(steps.clone()).filter(|own| !own.is_empty())?;
        let fastest_rad_s = planned[steps.clone()].iter().map(|planned| planned.1.abs()).fold(0.0, f64::max);
        Some(Motion { steps, fastest_rad_s, rms_rad: rms(own), peak_rad: largest(own) })
    };
    motions(planned).filter_map(motion).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Moves from 2, 7, 12 and 17 s on, 2 s each.
    fn planned() -> Vec<(f64, f64)> {
        let at = |t_s: f64| {
            [2.0, 7.0, 12.0, 17.0].iter().map(|from_s| ((t_s - from_s) / 2.0).clamp(0.0, 1.0)).sum::<f64>()
        };
        let speed = |t_s: f64| if t_s >= 2.0 && (t_s - 2.0) % 5.0 < 2.0 { 0.5 } else { 0.0 };
        (0..steps_in(22.0)).map(|k| k as f64 * STEP_S).map(|t_s| (0.1 * at(t_s), 0.1 * speed(t_s))).collect()
    }

    /// What is unexplained of each motion, at most, deg.
    fn left(of_motion_deg: [f64; 4]) -> Vec<f64> {
        let of = |t_s: f64| {
            let motion =
                [2.0, 7.0, 12.0, 17.0].iter().position(|from_s| (0.0..2.0).contains(&(t_s - from_s)));
            motion.map_or(0.0, |motion| of_motion_deg[motion] * DEGREE_RAD)
        };
        (0..steps_in(22.0)).map(|k| of(k as f64 * STEP_S)).collect()
    }

    #[test]
    fn a_motion_beyond_all_others_is_chance_until_it_comes_again() {
        let planned = planned();
        let found = |runs: &[[f64; 4]], of: usize| {
            in_run(&runs.iter().map(|run| left(*run)).collect::<Vec<_>>(), of, &planned)
        };
        let (steps, chance, keeps) = found(&[[0.4, 0.3, 3.0, 0.4]], 0).expect("one beyond all others");
        assert!((chance.from_s - 12.0).abs() < 0.05 && steps.contains(&steps_in(13.0)), "{chance:?}");
        assert!((chance.peak_rad - 3.0 * DEGREE_RAD).abs() < 1e-9 && (keeps - 0.4 / 3.0).abs() < 1e-6);
        assert!((chance.usual_rad - 0.4 * DEGREE_RAD).abs() < 1e-9, "{chance:?}");
        assert!(found(&[[0.4, 2.0, 3.0, 0.4]], 0).is_none(), "two of them");
        assert!(found(&[[0.04, 0.03, 0.3, 0.04]], 0).is_none(), "little");
        assert!(found(&[[0.4, 0.3, 3.0, 0.4], [0.4, 0.3, 2.0, 0.4]], 1).is_none(), "it came again");
        assert!(found(&[[0.4, 0.3, 3.0, 0.4], [0.4, 0.3, -2.0, 0.4]], 0).is_some(), "the other way");
        assert!(found(&[[0.4, 0.3, 0.4, 0.4], [0.4, 0.3, 3.0, 0.4]], 1).is_some(), "in the newest alone");
    }
}
