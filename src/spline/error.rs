//! Why key points and times make no trajectory.

use thiserror::Error;

/// What is wrong with key points, times, boundary values or dwells.
#[derive(Debug, Clone, Error, PartialEq)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the message says what each field is")]
pub enum SplineError {
    #[error("no joints")]
    NoJoints,
    #[error("{points} key points; at least 2 are needed")]
    TooFewPoints { points: usize },
    #[error("{found} values of {quantity}, {expected} expected")]
    LengthMismatch { quantity: &'static str, found: usize, expected: usize },
    /// A value is NaN, infinite, or too large to be cubed and squared.
    #[error("{quantity} {index} is not a number below 1e12 in magnitude: {value}")]
    NotFinite { quantity: &'static str, index: usize, value: f64 },
    #[error("no time to move to key point {}: leaving at {leave_s} s, arriving at {arrive_s} s", index + 1)]
    NotIncreasing { index: usize, leave_s: f64, arrive_s: f64 },
    /// Intervals so unequal that rounding hides the solution.
    #[error("intervals are too unequal: rounding would grow {inverse:.1e} times")]
    IllConditioned { inverse: f64 },
    #[error("dwell {} is at key point {}: dwells ascend and lie within the {points} key points", index + 1, point + 1)]
    BadDwell { index: usize, point: usize, points: usize },
    #[error("the dwell at key point {} lasts {length_s} s", point + 1)]
    NegativeDwell { point: usize, length_s: f64 },
    /// The trajectory begins or ends with a dwell, but not at rest.
    #[error(
        "a dwell at key point {}, where joint {} is to move: give it no speed and acceleration there, or no dwell",
        point + 1,
        joint + 1
    )]
    MovingDwell { point: usize, joint: usize },
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
