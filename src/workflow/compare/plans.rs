//! Whether two runs were asked to do the same.

use std::f64::consts::TAU;

use crate::{
    math::median,
    series::{JointKind, Pair},
    workflow::same_plan::may_differ_rad,
};

/// A clock is set right by the plans' shape at most by this, s.
const MOST_SHIFT_S: f64 = 0.2;
/// Two plans that share less of the shorter one's time are not compared.
const LEAST_OVERLAP: f64 = 0.5;

/// Plans at equal times.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PlanDifference {
    /// What is added to times of the first run to get those of the second, s.
    pub(super) offset_s: f64,
    /// Largest difference of joints that turn, rad, and of joints that slide, m; `None` without any.
    pub(super) most: [Option<f64>; 2],
    /// Whether they are the same plan.
    pub(super) same: bool,
}

/// Compares the plans of two runs whose clocks are `offset_s` apart, give or take what a start is known
/// to; `None` where too little of them was executed at equal times.
pub(super) fn plan_difference(pairs: &[(&Pair, &Pair)], offset_s: f64) -> Option<PlanDifference> {
    // A joint that began a whole turn further on does the same.
    let with_turns = |(a, b): &(&Pair, &Pair)| {
        let apart: Vec<f64> = instants(a, b, offset_s, 0.0).map(|at| at.difference_rad).collect();
        let turns =
            if a.kind == JointKind::Slides || apart.is_empty() { 0.0 } else { (median(apart) / TAU).round() };
        turns * TAU
    };
    let turns_rad: Vec<f64> = pairs.iter().map(with_turns).collect();
    let mut offset_s = offset_s;
    let first_s = offset_s;
    // Gauss-Newton on the shift.
    for _ in 0..3 {
        let (mut slope, mut energy) = (0.0, 0.0);
        for at in
            pairs.iter().zip(&turns_rad).flat_map(|((a, b), turns_rad)| instants(a, b, offset_s, *turns_rad))
        {
            slope += at.speed_rad_s * at.difference_rad;
            energy += at.speed_rad_s * at.speed_rad_s;
        }
        let shift_s = if energy > 0.0 { slope / energy } else { 0.0 };
        if (offset_s + shift_s - first_s).abs() > MOST_SHIFT_S {
            offset_s = first_s;
            break;
        }
        offset_s += shift_s;
    }
    let (mut most, mut same, mut enough) = ([None; 2], true, !pairs.is_empty());
    for ((a, b), turns_rad) in pairs.iter().zip(&turns_rad) {
        let of_kind = &mut most[usize::from(a.kind == JointKind::Slides)];
        let (mut own, mut count) = (of_kind.unwrap_or(0.0_f64), 0_usize);
        for at in instants(a, b, offset_s, *turns_rad) {
            count += 1;
            own = own.max(at.difference_rad.abs());
            same &= at.difference_rad.abs() <= may_differ_rad(at.speed_rad_s);
        }
        *of_kind = Some(own);
        enough &= count as f64 >= LEAST_OVERLAP * a.t_s.len().min(b.t_s.len()) as f64;
    }
    enough.then_some(PlanDifference { offset_s, most, same })
}

/// Two plans at one instant.
struct Instant {
    /// First minus second, rad.
    difference_rad: f64,
    /// Speed of the second, rad/s.
    speed_rad_s: f64,
}

/// The plans at those stamps of the first run at which the second has one, the first so far ahead by whole turns.
fn instants(a: &Pair, b: &Pair, offset_s: f64, turns_rad: f64) -> impl Iterator<Item = Instant> {
    let mut segment = 0;
    let mut k = 0;
    a.t_s.iter().zip(&a.planned).filter_map(move |(t_s, a_rad)| {
        let at_s = t_s + offset_s;
        while b.segments.get(segment).is_some_and(|s| b.t_s[s.end - 1] < at_s) {
            segment += 1;
        }
        let inside = b.segments.get(segment)?;
        k = k.max(inside.start);
        while k + 2 < inside.end && b.t_s[k + 1] < at_s {
            k += 1;
        }
        let next = k + 1;
        if next >= inside.end || !(b.t_s[k]..=b.t_s[next]).contains(&at_s) {
            return None;
        }
        let speed_rad_s = (b.planned[next] - b.planned[k]) / (b.t_s[next] - b.t_s[k]);
        let b_rad = b.planned[k] + speed_rad_s * (at_s - b.t_s[k]);
        Some(Instant { difference_rad: a_rad - turns_rad - b_rad, speed_rad_s })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::series::{Track, align};

    /// A plan that moves by a radian around 4 s.
    fn plan(shift_s: f64, scale: f64) -> Pair {
        let track = Track::sampled("a", 800, |t| scale * (2.0 * (t - 4.0 - shift_s)).tanh());
        Pair { segments: vec![0..300, 300..800], ..align(&track, &track).unwrap() }
    }

    #[test]
    fn a_plan_on_another_clock_is_the_same_plan_and_sets_the_clock_right() {
        let (a, b) = (plan(0.0, 0.5), plan(0.734, 0.5));
        let found = plan_difference(&[(&a, &b)], 0.66).unwrap();
        assert!((found.offset_s - 0.734).abs() < 1e-4 && found.same, "{found:?}");
        assert!(found.most[0].unwrap() < 1e-3, "{found:?}");
    }

    #[test]
    fn a_plan_that_goes_further_is_another_one() {
        let (a, b) = (plan(0.0, 0.5), plan(0.0, 0.505));
        let found = plan_difference(&[(&a, &b)], 0.0).unwrap();
        assert!(!found.same && (found.most[0].unwrap() - 0.005).abs() < 5e-4, "{found:?}");
        assert_eq!(plan_difference(&[(&a, &b)], 6.0), None);
        assert_eq!(plan_difference(&[], 0.0), None);
    }

    #[test]
    fn a_joint_that_began_a_turn_further_on_has_the_same_plan() {
        let (a, mut b) = (plan(0.0, 0.5), plan(0.0, 0.5));
        b.planned.iter_mut().for_each(|at| *at += TAU);
        let found = plan_difference(&[(&a, &b)], 0.0).unwrap();
        assert!(found.same && found.most[0].unwrap() < 1e-9, "{found:?}");
        b.kind = JointKind::Slides;
        assert!(!plan_difference(&[(&Pair { kind: JointKind::Slides, ..a }, &b)], 0.0).unwrap().same);
    }
}
