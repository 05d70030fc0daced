//! What a run left of error, and a joint that its corrections spoilt.

use super::correct::{NONE_RAD, largest};
use crate::{math::quantile, units::DEGREE_RAD};

/// Errors below this are not worth a step, rad.
pub(super) const MATTERS_RAD: f64 = 0.1 * DEGREE_RAD;

/// Root mean square error, and what the error is below for 95 % of the time, that are larger than others by these factors are more.
pub const MORE_ERROR: [f64; 2] = [1.02, 1.1];

/// What a run, or a part of one, left of error; a spike of a sensor is none.
#[derive(Debug, Clone, Copy)]
pub(super) struct Left {
    /// Root mean square without the largest fiftieth, rad.
    pub(super) rms_rad: f64,
    /// What it is below for 95 % of the time, rad.
    p95_rad: f64,
}

impl Left {
    pub(super) fn of(error_rad: &[f64]) -> Self {
        let mut squares: Vec<f64> = error_rad.iter().map(|error| error * error).collect();
        let kept = squares.len() - squares.len() / 50;
        if kept < squares.len() {
            squares.select_nth_unstable_by(kept, f64::total_cmp);
        }
        let rms_rad = (squares[..kept].iter().sum::<f64>() / kept.max(1) as f64).sqrt();
        Self { rms_rad, p95_rad: quantile(error_rad.iter().map(|error| error.abs()).collect(), 0.95) }
    }

    /// Whether it has a higher top, whatever was gained elsewhere.
    pub(super) fn tops(&self, other: &Self) -> bool {
        self.p95_rad > MORE_ERROR[1] * other.p95_rad
    }

    pub(super) fn is_more_than(&self, other: &Self) -> bool {
        self.rms_rad > MORE_ERROR[0] * other.rms_rad || self.tops(other)
    }
}

/// The run of which a joint is to be sent what it was sent, in place of `from`: where that left it more error over the whole run than
/// none did, the one that left least; and how many runs were spoilt, if that one was. Errors are of equally long runs.
pub(super) fn unspoilt(from: usize, sent: &[Vec<f64>], errors: &[Vec<f64>]) -> (usize, usize) {
    let left: Vec<Left> = errors.iter().map(|errors| Left::of(errors)).collect();
    let least = |all: &mut dyn Iterator<Item = usize>| {
        all.min_by(|a, b| left[*a].rms_rad.total_cmp(&left[*b].rms_rad))
    };
    let Some(plain) = least(&mut (0..left.len()).filter(|k| largest(&sent[*k]) <= NONE_RAD)) else {
        return (from, 0);
    };
    let spoilt = |k: &usize| left[*k].is_more_than(&left[plain]);
    if left[plain].p95_rad < MATTERS_RAD || !spoilt(&from) {
        return (from, 0);
    }
    let best = least(&mut (0..left.len()).filter(|k| !spoilt(k))).unwrap_or(plain);
    (best, (0..left.len()).filter(spoilt).count())
}

#[cfg(test)]
mod tests {
    use super::*;

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
}
