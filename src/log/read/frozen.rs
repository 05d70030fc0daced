//! Finds a sensor that repeats one value while the plan moves.

use crate::{
    series::{JointKind, Track},
    units::DEGREE_RAD,
};

/// A plan that moves by this much while the sensor repeats one value is beyond any dead-band.
const FROZEN_PLAN_RAD: f64 = 3.0 * DEGREE_RAD;
/// The same for a joint that slides.
const FROZEN_PLAN_M: f64 = 0.02;
const FROZEN_S: f64 = 0.5;

/// The longest stretch of exactly one measured value that lasts while the plan moves on: from, to, samples.
pub(super) fn frozen(planned: &Track, measured: &Track) -> Option<(f64, f64, u64)> {
    let (t_s, q) = (measured.t_s(), measured.position());
    let mut longest: Option<(usize, usize)> = None;
    let mut start = 0;
    // A stretch that lasts so long and begins no later than the first sample that is so late holds that sample.
    while let Some(after) = past(&t_s[start..], FROZEN_S) {
        let inside = start + after;
        let same = |i: &usize| q[*i].to_bits() == q[inside].to_bits();
        let first = (start..inside).rev().take_while(same).last().unwrap_or(inside);
        let end = (inside..q.len()).find(|i| !same(i)).unwrap_or(q.len());
        let long = t_s[end - 1] - t_s[first] > FROZEN_S && longest.is_none_or(|(a, b)| end - first > b - a);
        // A plan that leaves its rest within the last moments meets dead time.
        if long && plan_moves(planned, t_s[first], t_s[end - 1] - FROZEN_S) {
            longest = Some((first, end));
        }
        start = end;
    }
    longest.map(|(start, end)| (t_s[start], t_s[end - 1], (end - start) as u64))
}

/// The first of ascending times that is later than the first of all by more than a span: looked for by strides that
/// double, for it is near.
fn past(t_s: &[f64], span_s: f64) -> Option<usize> {
    let first_s = t_s.first()?;
    let within = |t: &f64| t - first_s <= span_s;
    let mut far = 1;
    while t_s.get(far).is_some_and(within) {
        far *= 2;
    }
    let near = far / 2;
    let at = near + t_s[near..far.min(t_s.len())].partition_point(within);
    (at < t_s.len()).then_some(at)
}

fn plan_moves(planned: &Track, from_s: f64, to_s: f64) -> bool {
    let range = |t: f64| planned.t_s().partition_point(|&s| s < t);
    let plan = &planned.position()[range(from_s)..range(to_s)];
    let (least, most) = plan.iter().fold((f64::MAX, f64::MIN), |(a, b), &q| (a.min(q), b.max(q)));
    let dead = match planned.kind() {
        JointKind::Turns => FROZEN_PLAN_RAD,
        JointKind::Slides => FROZEN_PLAN_M,
    };
    most - least > dead
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn a_rest_and_the_dead_time_after_it_are_no_frozen_sensor() {
        let t_s: Vec<f64> = (0..1000).map(|k| f64::from(k) * 0.01).collect();
        let track = |at: &dyn Fn(f64) -> f64| {
            Track::new("a", t_s.clone(), t_s.iter().map(|t| at(*t)).collect(), &[]).unwrap()
        };
        let moves = |t: f64| 0.5 * (t - 5.0).max(0.0);
        let stands_for = |s: f64| frozen(&track(&moves), &track(&|t| moves(t - s)));
        assert_eq!(stands_for(0.4), None);
        assert!(stands_for(1.0).is_some_and(|(from_s, to_s, _)| from_s < 0.1 && to_s > 5.9));
    }

    proptest! {
        #[test]
        fn the_stretch_that_stands_still_is_the_longest_of_all(
            samples in prop::collection::vec((1..400_u32, 0..8_u8, 0..3_u8), 1..40)
        ) {
            let (mut t_s, mut q) = (vec![0.0], vec![0.0]);
            for (step_ms, moves, to) in samples {
                t_s.push(t_s[t_s.len() - 1] + f64::from(step_ms) * 1e-3);
                q.push(if moves == 0 { f64::from(to) } else { q[q.len() - 1] });
            }
            let stretches = q.chunk_by(|a, b| a.to_bits() == b.to_bits()).scan(0, |end, stretch| {
                *end += stretch.len();
                Some((t_s[*end - stretch.len()], t_s[*end - 1], stretch.len() as u64))
            });
            let moved = |from_s: f64, to_s: f64| t_s.iter().filter(|t| (from_s..to_s).contains(*t)).count() > 1;
            let long =
                stretches.filter(|(from_s, to_s, _)| to_s - from_s > FROZEN_S && moved(*from_s, to_s - FROZEN_S));
            // The first of those that are equally long.
            let expected = long.reduce(|a, b| if b.2 > a.2 { b } else { a });
            let plan = t_s.iter().enumerate().map(|(k, _)| if k % 2 == 0 { 0.0 } else { 1.0 }).collect();
            let plan = Track::new("a", t_s.clone(), plan, &[]).unwrap();
            let measured = Track::new("a", t_s.clone(), q, &[]).unwrap();
            prop_assert_eq!(frozen(&plan, &measured), expected);
        }
    }
}
