//! Where more of a correction gained nothing: a valve, a pump or a stop holds the joint, not a want of correction.

use std::ops::Range;

use super::correct::{NONE_RAD, largest};
use crate::{math::quantile, units::DEGREE_RAD};

/// A correction has grown that is larger by this share of it and by this, rad.
const GREW: (f64, f64) = (0.2, 0.1 * DEGREE_RAD);

/// An error that is above this share of another, and above this, rad, is none the smaller for it.
const GAINED: f64 = 0.95;
const MATTERS_RAD: f64 = 0.1 * DEGREE_RAD;

/// Errors up to this times the least are as good.
const AS_GOOD: f64 = 1.1;

/// Root mean square error and top of it that are larger than others by these factors are no gain, whatever was gained elsewhere.
const WORSE: [f64; 2] = [1.02, 1.1];

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
    let (sizes, tops) = (in_it(sent, largest)?, in_it(errors, top)?);
    let errors = in_it(errors, trimmed)?;
    let least_rad = errors.iter().copied().fold(f64::INFINITY, f64::min);
    let corrected = |k: usize| sizes[k] > NONE_RAD;
    let grew = |other: usize, k: usize| sizes[other] > sizes[k] + f64::max(GREW.0 * sizes[k], GREW.1);
    let topped = |other: usize, k: usize| tops[other] > WORSE[1] * tops[k];
    // By how much corrections are larger than that of run `k` without gain.
    let idle = |k: usize| {
        let more = (0..sizes.len())
            .filter(|&other| grew(other, k) && (errors[other] > GAINED * errors[k] || topped(other, k)));
        more.map(|other| sizes[other] - sizes[k]).reduce(f64::max)
    };
    let spoils = |k: usize| {
        let worse = |other: usize| errors[other] > WORSE[0] * errors[k] || topped(other, k);
        // One correction may be mended by the next.
        let tried = (0..sizes.len()).filter(|other| corrected(*other));
        tried.clone().count() > 1 && tried.clone().all(worse)
    };
    let as_good = |k: usize| {
        errors[k] <= AS_GOOD * least_rad || (0..sizes.len()).all(|other| !grew(other, k) || topped(other, k))
    };
    let enough = (0..sizes.len())
        .filter(|&k| errors[k] > MATTERS_RAD && if corrected(k) { as_good(k) } else { spoils(k) })
        .filter_map(|k| Some((k, idle(k)?)));
    let (from, more_rad) = enough.min_by(|a, b| sizes[a.0].total_cmp(&sizes[b.0]))?;
    Some(Stalled { steps, from, more_rad, error_rad: errors[from] })
}

/// Root mean square error without the largest fiftieth of it: no spike of a sensor is.
pub(super) fn trimmed(error_rad: &[f64]) -> f64 {
    let mut squares: Vec<f64> = error_rad.iter().map(|error| error * error).collect();
    let kept = squares.len() - squares.len() / 50;
    if kept < squares.len() {
        squares.select_nth_unstable_by(kept, f64::total_cmp);
    }
    (squares[..kept].iter().sum::<f64>() / kept.max(1) as f64).sqrt()
}

/// The run of which a joint is to be sent what it was sent, in place of `from`: where that left it more error over the whole run than
/// none did, the one that left least; and how many runs were spoilt, if that one was. Errors are of equally long runs.
pub(super) fn unspoilt(from: usize, sent: &[Vec<f64>], errors: &[Vec<f64>]) -> (usize, usize) {
    let of: Vec<[f64; 2]> = errors.iter().map(|error| [trimmed(error), top(error)]).collect();
    let plain = (0..of.len()).filter(|k| largest(&sent[*k]) <= NONE_RAD);
    let Some(plain) = plain.min_by(|a, b| of[*a][0].total_cmp(&of[*b][0])) else { return (from, 0) };
    let spoilt = |k: &usize| of[*k][0] > WORSE[0] * of[plain][0] || of[*k][1] > WORSE[1] * of[plain][1];
    if of[plain][1] < MATTERS_RAD || !spoilt(&from) {
        return (from, 0);
    }
    let others = (0..of.len()).filter(|k| !spoilt(k));
    let least = others.min_by(|a, b| of[*a][0].total_cmp(&of[*b][0])).unwrap_or(plain);
    (least, (0..of.len()).filter(spoilt).count())
}

/// What an error is below for all but a twentieth of the time: no spike of a sensor is.
fn top(error_rad: &[f64]) -> f64 {
    quantile(error_rad.iter().map(|error| error.abs()).collect(), 0.95)
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
        // A first correction that gained nothing has no smaller one beside it; one that spoils is none the better for that.
        assert_eq!(found(&[[0.0; 2], [2.0; 2]], &[[3.0; 2], [3.0; 2]]), []);
        let spoilt = found(&[[0.0; 2], [2.0; 2], [3.0; 2]], &[[3.0; 2], [3.1, 2.0], [3.3, 1.0]]);
        assert!(matches!(&spoilt[..], [one] if one.steps == (0..4) && one.from == 0), "{spoilt:?}");
    }

    #[test]
    fn a_joint_that_a_correction_spoilt_is_sent_less_of_one() {
        let all = |of: &[f64]| of.iter().map(|of| vec![of * DEGREE_RAD; 200]).collect::<Vec<_>>();
        let sent = all(&[0.0, 1.0, 3.0]);
        assert_eq!(unspoilt(2, &sent, &all(&[6.8, 6.5, 7.4])), (1, 1));
        assert_eq!(unspoilt(2, &sent, &all(&[6.8, 7.0, 7.4])), (0, 2));
        assert_eq!(unspoilt(2, &sent, &all(&[6.8, 6.5, 6.6])), (2, 0));
        assert_eq!(unspoilt(2, &all(&[1.0; 3]), &all(&[6.8, 6.5, 7.4])), (2, 0), "none was sent as it is");
        // A spike of a sensor spoils nothing.
        let mut errors = all(&[1.0, 0.1, 0.05]);
        errors[2][7] = 100.0;
        assert_eq!(unspoilt(2, &sent, &errors), (2, 0));
    }

    #[test]
    fn runs_that_end_before_the_stretch_tell_nothing() {
        assert_eq!(stalled(&[vec![0.0; 4]], &[vec![1.0; 4]], std::slice::from_ref(&(2..6))), []);
    }
}
