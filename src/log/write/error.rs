//! Errors of writing a log.

use std::{error::Error, path::PathBuf};

use thiserror::Error;

/// Why something was not written. Whatever was written before stays readable; after
/// [`WriteError::Output`] nothing more can be.
#[derive(Debug, Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the message says what each field is")]
pub enum WriteError {
    #[error("no joint names")]
    NoJoints,
    #[error("joint name {index} is empty or holds a NUL: {name:?}")]
    BadJointName { index: usize, name: String },
    #[error("interface name {name:?} is empty or holds a NUL")]
    Interface { name: String },
    #[error("{kind} {name:?} is empty or holds a NUL")]
    Text { kind: &'static str, name: String },
    #[error("{kind} {name} is given twice")]
    Duplicate { kind: &'static str, name: String },
    #[error("{values} values of {quantity} for {joints} joints")]
    LengthMismatch { quantity: &'static str, joints: usize, values: usize },
    /// A time that messages cannot hold: stamps lie in 1970 to 2038, durations within 68 years.
    #[error("{quantity} {value_ns} ns does not fit a message")]
    TimeRange { quantity: &'static str, value_ns: i64 },
    #[error("the rate is {found} Hz; a rate from {least} to {most} Hz is expected")]
    Rate { found: f64, least: f64, most: f64 },
    #[error(
        "a plan of {duration_s:.0} s at {rate_hz} Hz has more than {most} samples: give a lower rate, or a shorter plan"
    )]
    TooLong { duration_s: f64, rate_hz: f64, most: f64 },
    #[error("time from start does not increase at point {index}: {previous_ns} ns then {next_ns} ns")]
    NotIncreasing { index: usize, previous_ns: i64, next_ns: i64 },
    /// The file cannot be created, for one because it exists already.
    #[error("cannot create {path}")]
    Create { path: PathBuf, source: std::io::Error },
    /// The output rejects bytes now, or rejected some before.
    #[error("the log cannot be written")]
    Output(#[source] Box<dyn Error + Send + Sync>),
}

impl From<mcap::McapError> for WriteError {
    fn from(error: mcap::McapError) -> Self {
        Self::Output(Box::new(error))
    }
}
