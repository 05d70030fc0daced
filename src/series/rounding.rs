//! To which step a plan was rounded when it was written.

use super::Track;

/// Smaller steps are rounding of numbers, rad or m.
const DUST: f64 = 2.5e-7;
/// So many changes are looked at, and so many at least.
const MOST: usize = 20_000;
const LEAST: usize = 20;
/// A multiple lies so near to one, in steps.
const NEAR: f64 = 0.05;

/// The step that all positions of a plan lie apart by, in its unit; `None` where they do not lie on one, or change too
/// seldom to tell.
pub(super) fn rounding(plan: &Track) -> Option<f64> {
    let x = plan.position();
    let pairs = plan.segments().iter().flat_map(|s| (s.start + 1..s.end).map(|i| (x[i] - x[i - 1]).abs()));
    let moved: Vec<f64> = pairs.filter(|step| *step > DUST).take(MOST).collect();
    let step = moved.iter().copied().min_by(f64::total_cmp)?;
    let multiple = |one: &&f64| (*one / step - (*one / step).round()).abs() < NEAR;
    let multiples = moved.iter().filter(multiple).count();
    (moved.len() >= LEAST && 20 * multiples >= 19 * moved.len()).then_some(step)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan(written: impl Fn(f64) -> f64) -> Track {
        let t_s: Vec<f64> = (0..1000).map(|k| f64::from(k) * 0.01).collect();
        let position = t_s.iter().map(|t| written(0.3 * (0.7 * t).sin())).collect();
        Track::new("a", t_s, position, &[]).unwrap()
    }

    #[test]
    fn a_rounded_plan_shows_its_step_and_a_smooth_one_has_none() {
        for step in [1e-5, 1e-4, 2e-3] {
            let found = rounding(&plan(|x| (x / step).round() * step)).unwrap();
            assert!((found / step - 1.0).abs() < 1e-3, "{found} for {step}");
        }
        assert_eq!(rounding(&plan(|x| x)), None);
    }
}
