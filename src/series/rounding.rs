//! To which step a plan was rounded when it was written.

use super::{JointKind, Track};
use crate::{math::median, units::DEGREE_RAD};

/// Smaller steps are rounding of numbers, rad or m.
const DUST: f64 = 2.5e-7;
/// So many changes are looked at, and so many at least.
const MOST: usize = 20_000;
const LEAST: usize = 20;
/// A multiple lies so near to one, in steps.
const NEAR: f64 = 0.05;

/// Share of the changes, and how many, at least, that rounding shows in.
const SHOWN: f64 = 0.01;
const LEAST_SHOWN: usize = 3;
/// A change of so many steps between rows that stand is one of a plan that is held, not rounded.
const JUMP: i64 = 3;
/// Rows that stand for longer are a rest.
const REST: usize = 5;

/// Steps from here on, rad or m, that mostly stand for so long, s, are what is asked for: a joint follows each.
const ASKED: [f64; 2] = [0.5 * DEGREE_RAD, 5e-3];
const STANDS_S: f64 = 0.5;

/// The step that a plan is rounded to, in its unit; `None` where its positions do not lie on one, change too seldom to
/// tell, or do so as no rounding makes them: ramps and even accelerations lie on steps, too.
pub(crate) fn rounding(plan: &Track) -> Option<f64> {
    let x = plan.position();
    let changes = || plan.segments().iter().flat_map(|s| (s.start + 1..s.end).map(|i| x[i] - x[i - 1]));
    let moved: Vec<f64> = changes().map(f64::abs).filter(|step| *step > DUST).take(MOST).collect();
    let step = moved.iter().copied().min_by(f64::total_cmp)?;
    let multiple = |one: &&f64| (*one / step - (*one / step).round()).abs() < NEAR;
    let multiples = moved.iter().filter(multiple).count();
    if moved.len() < LEAST || 20 * multiples < 19 * moved.len() {
        return None;
    }
    if step >= ASKED[usize::from(plan.kind() == JointKind::Slides)] && stands_s(plan) >= STANDS_S {
        return None;
    }
    #[expect(clippy::cast_possible_truncation, reason = "a jump of more steps is one, too")]
    let steps: Vec<i64> = changes().map(|change| (change / step).round() as i64).collect();
    let shown = shown(&steps);
    (shown >= LEAST_SHOWN && shown as f64 >= SHOWN * moved.len() as f64).then_some(step)
}

/// Median time from a change to the next, s.
fn stands_s(plan: &Track) -> f64 {
    let (t_s, x) = (plan.t_s(), plan.position());
    let changed = plan
        .segments()
        .iter()
        .flat_map(|s| (s.start + 1..s.end).filter(|i| (x[*i] - x[*i - 1]).abs() > DUST));
    let changed_s: Vec<f64> = changed.take(MOST).map(|i| t_s[i]).collect();
    median(changed_s.windows(2).map(|two| two[1] - two[0]).collect())
}

/// How often changes in steps show that they were rounded: one step between rows that stand, or a speed that dips.
fn shown(steps: &[i64]) -> usize {
    let alone = |two: &[i64]| two[0] == 0 && two[2] == 0;
    let lone = steps.windows(3).filter(|near| near[1].abs() == 1 && alone(near)).count();
    let jumps = steps.windows(3).filter(|near| near[1].abs() >= JUMP && alone(near)).count();
    let (mut dips, mut fell, mut stands) = (0, false, 0);
    for two in steps.windows(2) {
        let [before, now] = [two[0].abs(), two[1].abs()];
        stands = if now == 0 { stands + 1 } else { 0 };
        let turned = two[0] * two[1] < 0;
        if turned || stands > REST {
            fell = false;
        } else if now < before {
            fell = true;
        } else if now > before && fell {
            (dips, fell) = (dips + 1, false);
        }
    }
    if jumps > lone { 0 } else { dips + lone }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan(written: impl Fn(f64) -> f64) -> Track {
        Track::sampled("a", 1000, |t| written(0.3 * (0.7 * t).sin()))
    }

    #[test]
    fn a_rounded_plan_shows_its_step_and_a_smooth_one_has_none() {
        for step in [1e-5, 1e-4, 2e-3] {
            let found = rounding(&plan(|x| (x / step).round() * step)).unwrap();
            assert!((found / step - 1.0).abs() < 1e-3, "{found} for {step}");
        }
        assert_eq!(rounding(&plan(|x| x)), None);
    }

    #[test]
    fn even_accelerations_and_held_values_lie_on_steps_and_are_not_rounded() {
        // Three motions that accelerate, cruise and slow down evenly, 10 times a second, at rest between.
        let at = |t_s: f64| {
            let one = |from_s: f64| {
                let t = (t_s - from_s).clamp(0.0, 3.0);
                let slows = (t - 2.5).max(0.0);
                0.5 * t.min(0.5) * t.min(0.5) + 0.5 * (t - 0.5).max(0.0) - 0.5 * slows * slows
            };
            0.3 * (one(1.0) + one(6.0) - one(11.0))
        };
        let track = |every_s: f64, held_s: f64| {
            let t_s: Vec<f64> = (0..).map(|k| f64::from(k) * every_s).take(1500).collect();
            let q = t_s.iter().map(|t| at(((t + 1e-9) / held_s).floor() * held_s)).collect();
            rounding(&Track::new("a", t_s, q, &[]).unwrap())
        };
        assert_eq!((track(0.1, 0.1), track(0.05, 0.05), track(0.01, 0.05)), (None, None, None));
        // Set values that go between two angles, and a slow plan in steps as coarse as a hundredth of that.
        let t_s: Vec<f64> = (0..6000).map(|k| f64::from(k) * 0.01).collect();
        let of = |at: &dyn Fn(f64) -> f64| {
            rounding(&Track::new("a", t_s.clone(), t_s.iter().map(|t| at(*t)).collect(), &[]).unwrap())
        };
        assert_eq!(of(&|t| 0.2 * (0.5 * t).floor().rem_euclid(2.0)), None);
        assert!(of(&|t| 0.002 * (0.5 * t).floor()).is_some());
    }
}
