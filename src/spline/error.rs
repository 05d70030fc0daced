//! Why key points and times make no trajectory.

use thiserror::Error;

/// What is wrong with key points, times, boundary values or dwells.
#[derive(Debug, Clone, Error, PartialEq)]
#[non_exhaustive]
pub enum SplineError {
    /// Nothing to move.
    #[error("no joints")]
    NoJoints,
    /// A trajectory leads from somewhere to somewhere.
    #[error("{points} key points; at least 2 are needed")]
    TooFewPoints {
        /// Number of key points.
        points: usize,
    },
    /// Arrays do not run in parallel.
    #[error("{found} values of {quantity}, {expected} expected")]
    LengthMismatch {
        /// Which array.
        quantity: &'static str,
        /// Its length.
        found: usize,
        /// The length it should have.
        expected: usize,
    },
    /// A value is NaN, infinite, or too large to be cubed and squared.
    #[error("{quantity} {index} is not a number below 1e12 in magnitude: {value}")]
    NotFinite {
        /// Which array.
        quantity: &'static str,
        /// Index into it.
        index: usize,
        /// The value.
        value: f64,
    },
    /// The time to move between two key points is none, or too short to be told from none.
    #[error("no time to move to key point {index}: leaving at {leave_s} s, arriving at {arrive_s} s")]
    NotIncreasing {
        /// Index of the later key point.
        index: usize,
        /// When the arm leaves the earlier one, s.
        leave_s: f64,
        /// When it should reach the later one, s.
        arrive_s: f64,
    },
    /// Intervals so unequal that rounding hides the solution.
    #[error("intervals are too unequal: rounding would grow {inverse:.1e} times")]
    IllConditioned {
        /// Norm of the system's inverse.
        inverse: f64,
    },
    /// Dwells are not at distinct key points in ascending order.
    #[error("dwell {index} is at key point {point}: dwells ascend and lie within the {points} key points")]
    BadDwell {
        /// Index of the dwell.
        index: usize,
        /// The key point it names.
        point: usize,
        /// Number of key points.
        points: usize,
    },
    /// A rest of negative length.
    #[error("the dwell at key point {point} lasts {length_s} s")]
    NegativeDwell {
        /// The key point.
        point: usize,
        /// Its length, s.
        length_s: f64,
    },
    /// The trajectory begins or ends with a dwell, but not at rest.
    #[error("a dwell at key point {point}, where joint {joint} is not at rest")]
    MovingDwell {
        /// The first or last key point.
        point: usize,
        /// A joint that moves there.
        joint: usize,
    },
}

/// Largest magnitude accepted; derivatives, their squares and integrals then stay finite.
const LARGEST: f64 = 1e12;

/// Passes if there are `expected` values, all finite and of sane size.
pub(super) fn check(quantity: &'static str, values: &[f64], expected: usize) -> Result<(), SplineError> {
    if values.len() != expected {
        return Err(SplineError::LengthMismatch { quantity, found: values.len(), expected });
    }
    match values.iter().position(|value| value.is_nan() || value.abs() > LARGEST) {
        Some(index) => Err(SplineError::NotFinite { quantity, index, value: values[index] }),
        None => Ok(()),
    }
}
