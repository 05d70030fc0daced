//! What can go wrong while a log is written.

use std::{error::Error, path::PathBuf};

use thiserror::Error;

/// Why something was not written. Whatever was written before stays readable; after
/// [`WriteError::Output`] nothing more can be.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum WriteError {
    /// There is no joint to write about.
    #[error("no joint names")]
    NoJoints,
    /// A joint name that no reader could give back.
    #[error("joint name {index} is empty or holds a NUL: {name:?}")]
    BadJointName {
        /// Index in the list of joints.
        index: usize,
        /// The name.
        name: String,
    },
    /// A name of a quantity that no reader could give back.
    #[error("interface name {name:?} is empty or holds a NUL")]
    Interface {
        /// The name.
        name: String,
    },
    /// A name of a frame, or a text, that no reader could give back.
    #[error("{kind} {name:?} is empty or holds a NUL")]
    Text {
        /// Frame or robot description.
        kind: &'static str,
        /// What was given, or how it begins.
        name: String,
    },
    /// Two joints or two topics of one name.
    #[error("{kind} {name} is given twice")]
    Duplicate {
        /// Joint or topic.
        kind: &'static str,
        /// The name.
        name: String,
    },
    /// A quantity is given for some joints only.
    #[error("{values} values of {quantity} for {joints} joints")]
    LengthMismatch {
        /// Which quantity.
        quantity: &'static str,
        /// Number of joints.
        joints: usize,
        /// Number of values.
        values: usize,
    },
    /// A time that messages cannot hold: stamps lie in 1970 to 2038, durations within 68 years.
    #[error("{quantity} {value_ns} ns does not fit a message")]
    TimeRange {
        /// Which time.
        quantity: &'static str,
        /// Its value, ns.
        value_ns: i64,
    },
    /// The points of a trajectory do not follow each other.
    #[error("time from start does not increase at point {index}: {previous_ns} ns then {next_ns} ns")]
    NotIncreasing {
        /// Index of the later point.
        index: usize,
        /// The earlier time, ns.
        previous_ns: i64,
        /// The later time, ns.
        next_ns: i64,
    },
    /// The file cannot be created, for one because it exists already.
    #[error("cannot create {path}")]
    Create {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The output takes no more, or took none before.
    #[error("the log cannot be written")]
    Output(#[source] Box<dyn Error + Send + Sync>),
}

impl From<mcap::McapError> for WriteError {
    fn from(error: mcap::McapError) -> Self {
        Self::Output(Box::new(error))
    }
}
