//! A newest plan that is another run's plan and a correction of what that run was off by: it is what was sent, as a PLC logs it, and the
//! arm is to follow the plan behind it. Corrected once more, each command would lead farther away from that.

use crate::{
    log::Recording,
    math::{range, rms},
    series::{Series, SignalError, Track, bridged},
    workflow::carried::Carried,
};

/// How far a correction and the error behind it are the same but for their size and for a part that goes with the speed, 0 to 1, and what
/// share of it is one at most.
const ALIKE: f64 = 0.65;
const MOST_SHARE: f64 = 2.5;

/// Or, where nearly all of a correction is to be early, how little of the error plans differ by that are laid upon each other: more than by
/// their stamps and less than those of other motions do.
const LITTLE: [f64; 2] = [0.05, 0.3];
/// What they differ by is then a little like the error; that of stamps that jitter is not.
const LITTLE_ALIKE: f64 = 0.12;

/// Plans that differ by less are one, rad or m, root mean square; they begin and end within this share of their range, and so many of the
/// joints that move are corrected.
const LEAST: f64 = 3e-4;
const ENDS: f64 = 0.05;
const MOST_JOINTS: f64 = 0.7;

/// Plans are compared every so often, and where they lie upon each other best up to so many steps apart: logs begin when they do, s.
const STEP_S: f64 = 0.05;
const STEPS: i32 = 30;

/// The log, of those with other plans, whose plan the newest plan is with a correction, if there is one.
pub(super) fn behind<'a>(
    names: &'a [String],
    observed: &[Recording],
    others: &[String],
) -> Result<Option<&'a str>, SignalError> {
    let Some(newest) = observed.last() else { return Ok(None) };
    // What a log with both, or with its task, says of its plan holds.
    if newest.command.is_some() || Carried::of(newest).chosen().is_some() {
        return Ok(None);
    }
    let plan = &*bridged(&newest.planned)?;
    for (name, other) in names.iter().zip(observed).rev().filter(|(name, _)| others.contains(name)) {
        if is_corrected(plan, &*bridged(&other.planned)?, &other.measured) {
            return Ok(Some(name));
        }
    }
    Ok(None)
}

/// Whether a plan is another one and a share of what a run of that was off by, in most of its joints.
fn is_corrected(plan: &Series, other: &Series, came: &Series) -> bool {
    let own = |track: &Track| {
        let (plan, came) = (plan.track(track.name())?, came.track(track.name())?);
        let [from_s, to_s] = [came.t_s().first()?, came.t_s().last()?];
        let t_s = (0_u32..).map(|k| from_s + STEP_S * f64::from(k)).take_while(|t_s| t_s <= to_s);
        let t_s: Vec<f64> = t_s.collect();
        let at = |track: &Track, by_s: f64| -> Vec<f64> {
            t_s.iter().map(|t_s| track.held_at(t_s + by_s).position).collect()
        };
        let (own, came) = (at(track, 0.0), at(came, 0.0));
        let differs = |by: i32| less(&at(plan, STEP_S * f64::from(by)), &own);
        let nearest = (-STEPS..=STEPS).map(differs).min_by(|a, b| rms(a).total_cmp(&rms(b)))?;
        let speed: Vec<f64> = own.windows(2).map(|two| two[1] - two[0]).chain([0.0]).collect();
        // Another pace makes a plan later in proportion to the time.
        let later: Vec<f64> = speed.iter().zip(&t_s).map(|(speed, t_s)| speed * t_s).collect();
        let later = without(later, &speed);
        let error = less(&own, &came);
        let [least, most] = range(own.iter().copied());
        let same_ends = [nearest.first(), nearest.last()]
            .iter()
            .all(|end| end.is_some_and(|by| by.abs() < ENDS * (most - least)));
        let left = rms(&error);
        let [differs, error] = [nearest, error].map(|values| without(values, &speed));
        let [on_pace, left_on_pace] = [&differs, &error].map(|values| without(values.clone(), &later));
        let little = (LITTLE[0]..LITTLE[1]).contains(&(rms(&on_pace) / left));
        let told =
            is_share(&differs, &error, ALIKE) || little && is_share(&on_pace, &left_on_pace, LITTLE_ALIKE);
        (rms(&speed) > 0.0).then_some(same_ends && rms(&differs) > LEAST && told)
    };
    let all: Vec<bool> = other.tracks.iter().filter_map(own).collect();
    let corrected = all.iter().filter(|is| **is).count();
    corrected > 0 && corrected as f64 >= MOST_JOINTS * all.len() as f64
}

fn less(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

fn product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Values without the part of them that goes with others.
fn without(values: Vec<f64>, others: &[f64]) -> Vec<f64> {
    let share = product(&values, others) / product(others, others);
    values.into_iter().zip(others).map(|(value, other)| value - share * other).collect()
}

/// Whether one is a share of the other, and so far the same.
fn is_share(differs: &[f64], error: &[f64], alike: f64) -> bool {
    let (along, all) = (product(differs, error), product(error, error));
    along > alike * (product(differs, differs) * all).sqrt() && along < MOST_SHARE * all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::smooth_step as step;

    #[test]
    fn a_plan_with_a_correction_is_told_and_one_that_is_faster_or_goes_elsewhere_is_not() {
        let swing =
            |t: f64| step((t - 3.0) / 5.0) - 0.6 * step((t - 12.0) / 5.0) + 0.2 * step((t - 20.0) / 4.0);
        let series = |of: &dyn Fn(f64) -> f64| Series::sampled("swing", 2800, of);
        // A dead band, and a lag.
        let error = |t: f64| {
            let speed = (swing(t + 0.01) - swing(t - 0.01)) / 0.02;
            0.02 * (speed / 0.02).clamp(-1.0, 1.0) + 0.3 * speed
        };
        let (plan, came) = (series(&swing), series(&|t| swing(t) - error(t)));
        let told = |of: &dyn Fn(f64) -> f64| is_corrected(&series(of), &plan, &came);
        for later_s in [0.0, 0.7] {
            assert!(told(&|t| swing(t - later_s) + 0.5 * error(t - later_s)), "{later_s}");
            assert!(told(&|t| swing(t - later_s) + error(t - later_s)), "{later_s}");
            assert!(!told(&|t| swing(t - later_s)), "the same, {later_s}");
        }
        assert!(
            !told(&|t| swing(3.0 + 1.02 * (t - 3.0))) && !told(&|t| swing(3.0 + 0.97 * (t - 3.0))),
            "another pace"
        );
        let jitters = |t: f64| 0.02 * (31.0 * t).sin() + 0.02 * (17.0 * t + 1.0).cos();
        assert!(!told(&|t| swing(t + jitters(t))), "stamps that jitter");
        assert!(!told(&|t| 1.1 * swing(t)) && !told(&|t| 0.9 * swing(t)), "farther, or less far");
    }
}
