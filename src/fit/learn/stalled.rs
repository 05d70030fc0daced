//! Where more of a correction gained nothing: a valve, a pump or a stop holds the joint, not a want of correction.

use std::ops::Range;

use super::correct::{NONE_RAD, largest, rms};
use crate::units::DEGREE_RAD;

/// A correction has grown that is larger by this share of it and by this, rad.
const GREW: (f64, f64) = (0.2, 0.1 * DEGREE_RAD);

/// An error that is above this share of another, and above this, rad, is none the smaller for it.
const GAINED: f64 = 0.95;
const MATTERS_RAD: f64 = 0.1 * DEGREE_RAD;

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

/// Of runs with what was added to the plan in each and what they were off by, rad; at most one entry a stretch.
pub(super) fn stalled(sent: &[Vec<f64>], errors: &[Vec<f64>], free: &[Range<usize>]) -> Vec<Stalled> {
    free.iter().filter_map(|steps| of_stretch(sent, errors, steps.clone())).collect()
}

fn of_stretch(sent: &[Vec<f64>], errors: &[Vec<f64>], steps: Range<usize>) -> Option<Stalled> {
    let in_it = |all: &[Vec<f64>], of: fn(&[f64]) -> f64| -> Option<Vec<f64>> {
        all.iter().map(|values| values.get(steps.clone()).map(of)).collect()
    };
    let (sizes, errors) = (in_it(sent, largest)?, in_it(errors, rms)?);
    let least_rad = errors.iter().copied().fold(f64::INFINITY, f64::min);
    // The corrections that are larger than that of run `k` without gain.
    let idle = |k: usize| {
        let (size, error) = (sizes[k], errors[k]);
        let more = sizes.iter().zip(&errors).filter(move |(other, left)| {
            **other > size + f64::max(GREW.0 * size, GREW.1) && **left > GAINED * error
        });
        more.map(|(other, _)| other - size).reduce(f64::max)
    };
    let enough = (0..sizes.len())
        .filter(|&k| sizes[k] > NONE_RAD && errors[k] > MATTERS_RAD && errors[k] <= AS_GOOD * least_rad)
        .filter_map(|k| Some((k, idle(k)?)));
    let (from, more_rad) = enough.min_by(|a, b| sizes[a.0].total_cmp(&sizes[b.0]))?;
    Some(Stalled { steps, from, more_rad, error_rad: errors[from] })
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
        // A first correction that gained nothing has no smaller one beside it.
        assert_eq!(found(&[[0.0; 2], [2.0; 2]], &[[3.0; 2], [3.0; 2]]), []);
    }

    #[test]
    fn runs_that_end_before_the_stretch_tell_nothing() {
        assert_eq!(stalled(&[vec![0.0; 4]], &[vec![1.0; 4]], std::slice::from_ref(&(2..6))), []);
    }
}
