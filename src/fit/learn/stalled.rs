//! Where more of a correction gained nothing: a valve, a pump or a stop holds the joint, not a want of correction.

use std::ops::Range;

use super::{
    correct::{NONE_RAD, largest},
    spoilt::{Left, MATTERS_RAD},
};
use crate::{math::rms, units::DEGREE_RAD};

/// A correction has grown that is larger by this share of it and by this, rad.
const GREW: (f64, f64) = (0.2, 0.1 * DEGREE_RAD);

/// An error that is above this share of another is none the smaller for it.
const GAINED: f64 = 0.95;

/// One that is above another by this factor is no longer the same.
const FAR: f64 = 1.3;

/// Errors up to this times the least are as good.
const AS_GOOD: f64 = 1.1;

/// A stretch of motion in which a larger correction gained nothing.
#[derive(Debug, Clone, PartialEq)]
pub struct Stalled {
    /// Steps of the plan.
    pub steps: Range<usize>,
    /// The run (by index) whose smaller correction was as good.
    pub from: usize,
    /// By how much the largest correction was larger, rad.
    pub more_rad: f64,
    /// Root mean square error that stayed, rad.
    pub error_rad: f64,
}

/// Errors whose product is more than this share of that of their sizes are alike.
const ALIKE: f64 = 0.7;

/// Of runs with what was added to the plan in each and what they were off by, rad; at most one entry a stretch.
pub(super) fn stalled(sent: &[Vec<f64>], errors: &[Vec<f64>], free: &[Range<usize>]) -> Vec<Stalled> {
    free.iter().filter_map(|steps| of_stretch(sent, errors, steps.clone())).collect()
}

fn of_stretch(sent: &[Vec<f64>], errors: &[Vec<f64>], steps: Range<usize>) -> Option<Stalled> {
    let in_it = |all: &[Vec<f64>]| -> Option<Vec<Vec<f64>>> {
        all.iter().map(|values| Some(values.get(steps.clone())?.to_vec())).collect()
    };
    let sizes: Vec<f64> = in_it(sent)?.iter().map(|sent| largest(sent)).collect();
    let errors = in_it(errors)?;
    let left: Vec<Left> = errors.iter().map(|errors| Left::of(errors)).collect();
    // What a limit leaves is the same error; that of a machine that has changed meanwhile is another.
    let alike = |one: usize, other: usize| {
        let product: f64 = errors[one].iter().zip(&errors[other]).map(|(a, b)| a * b).sum();
        product > ALIKE * errors[one].len() as f64 * rms(&errors[one]) * rms(&errors[other])
    };
    let least_rad = left.iter().map(|left| left.rms_rad).fold(f64::INFINITY, f64::min);
    let corrected = |k: usize| sizes[k] > NONE_RAD;
    let grew = |other: usize, k: usize| sizes[other] > sizes[k] + f64::max(GREW.0 * sizes[k], GREW.1);
    // By how much corrections are larger than that of run `k` without gain.
    let idle = |k: usize| {
        let gained_nothing =
            |other: usize| left[other].rms_rad > GAINED * left[k].rms_rad || left[other].tops(&left[k]);
        // A larger one before it was for another machine, as one that was cold.
        let same = |other: usize| !corrected(k) || other > k && alike(k, other);
        let more =
            || (0..sizes.len()).filter(|&other| grew(other, k) && gained_nothing(other) && same(other));
        // A limit leaves as much; of what came to far more one run may be a bad day's.
        let held = more().any(|other| left[other].rms_rad < FAR * left[k].rms_rad) || more().count() > 1;
        more().map(|other| sizes[other] - sizes[k]).filter(|_| held || !corrected(k)).reduce(f64::max)
    };
    let spoils = |k: usize| {
        // One correction may be mended by the next.
        let tried = (0..sizes.len()).filter(|other| corrected(*other));
        tried.clone().count() > 1 && tried.clone().all(|other| left[other].is_more_than(&left[k]))
    };
    let as_good = |k: usize| {
        left[k].rms_rad <= AS_GOOD * least_rad
            || (0..sizes.len()).all(|other| !grew(other, k) || left[other].tops(&left[k]))
    };
    let enough = (0..sizes.len())
        .filter(|&k| left[k].rms_rad > MATTERS_RAD && if corrected(k) { as_good(k) } else { spoils(k) })
        .filter_map(|k| Some((k, idle(k)?)));
    let (from, more_rad) = enough.min_by(|a, b| sizes[a.0].total_cmp(&sizes[b.0]))?;
    Some(Stalled { steps, from, more_rad, error_rad: left[from].rms_rad })
}

#[cfg(test)]
mod tests {
    use super::*;

    const STRETCHES: [Range<usize>; 2] = [0..4, 4..8];

    /// A run that was sent `sent` and was off by `error` in each stretch, deg.
    fn run(of_stretch: [f64; 2]) -> Vec<f64> {
        of_stretch.iter().flat_map(|value| [value * DEGREE_RAD; 4]).collect()
    }

    fn found(sent: &[[f64; 2]], errors: &[[f64; 2]]) -> Vec<Stalled> {
        let all = |of: &[[f64; 2]]| of.iter().map(|of| run(*of)).collect::<Vec<_>>();
        stalled(&all(sent), &all(errors), &STRETCHES)
    }

    #[test]
    fn a_correction_that_grew_without_gain_is_found_in_its_stretch_alone() {
        let found = found(&[[0.0, 0.0], [2.0, 2.0], [4.0, 3.0]], &[[3.0, 3.0], [1.0, 1.0], [0.99, 0.5]]);
        let [one] = found.as_slice() else { panic!("{found:?}") };
        assert_eq!((one.steps.clone(), one.from), (0..4, 1));
        assert!((one.more_rad - 2.0 * DEGREE_RAD).abs() < 1e-12, "{one:?}");
        assert!((one.error_rad - DEGREE_RAD).abs() < 1e-12, "{one:?}");
    }

    #[test]
    fn what_gains_matters_little_or_did_not_grow_goes_on() {
        // A tenth was gained.
        assert_eq!(found(&[[0.0; 2], [2.0; 2], [4.0; 2]], &[[3.0; 2], [1.0; 2], [0.9; 2]]), []);
        // Both are near the noise.
        assert_eq!(found(&[[0.0; 2], [2.0; 2], [4.0; 2]], &[[3.0; 2], [0.08; 2], [0.08; 2]]), []);
        // The correction is the same.
        assert_eq!(found(&[[0.0; 2], [2.0; 2], [2.1; 2]], &[[3.0; 2], [1.0; 2], [1.0; 2]]), []);
        // One run in which it came to far more tells of no limit, two do.
        assert_eq!(found(&[[0.0; 2], [2.0; 2], [3.0; 2]], &[[3.0; 2], [1.0; 2], [1.5; 2]]), []);
        let twice =
            found(&[[0.0; 2], [2.0; 2], [3.0; 2], [2.6; 2]], &[[3.0; 2], [1.0; 2], [1.5; 2], [1.4; 2]]);
        assert!(twice.len() == 2 && twice.iter().all(|held| held.from == 1), "{twice:?}");
        // A first correction that gained nothing has no smaller one beside it; one that spoils is none the better for that.
        assert_eq!(found(&[[0.0; 2], [2.0; 2]], &[[3.0; 2], [3.0; 2]]), []);
        let spoilt = found(&[[0.0; 2], [2.0; 2], [3.0; 2]], &[[3.0; 2], [3.1, 2.0], [3.3, 1.0]]);
        assert!(matches!(&spoilt[..], [one] if one.steps == (0..4) && one.from == 0), "{spoilt:?}");
    }

    #[test]
    fn runs_that_end_before_the_stretch_tell_nothing() {
        assert_eq!(stalled(&[vec![0.0; 4]], &[vec![1.0; 4]], std::slice::from_ref(&(2..6))), []);
    }
}
