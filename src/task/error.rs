//! Why a text is no task.

use std::path::PathBuf;

use thiserror::Error;

/// Why a text is no task; lines count from 1.
#[derive(Debug, Clone, Error, PartialEq)]
#[non_exhaustive]
pub enum TaskError {
    /// The file cannot be read.
    #[error("cannot read the task {}: {reason}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        reason: String,
    },
    /// The text is no TOML, or has keys that no task has.
    #[error("line {line}: {message}")]
    Syntax {
        /// Where.
        line: usize,
        /// What is wrong; names the keys that belong there.
        message: String,
    },
    /// A joint that the task does not declare.
    #[error("line {line}: {key} names the joint {joint:?}; the task's joints are {declared}")]
    UnknownJoint {
        /// Where.
        line: usize,
        /// The table it stands in.
        key: String,
        /// The joint.
        joint: String,
        /// The joints of the task.
        declared: String,
    },
    /// A joint that is left out where all are needed.
    #[error("line {line}: {key} has no value for the joint {joint:?}; give one for each of {declared}")]
    MissingJoint {
        /// Where.
        line: usize,
        /// The table.
        key: String,
        /// The joint.
        joint: String,
        /// The joints of the task.
        declared: String,
    },
    /// A list of the wrong length.
    #[error("line {line}: {key} has {found} values, {expected} are needed ({why})")]
    Length {
        /// Where.
        line: usize,
        /// Which list.
        key: String,
        /// How many there are.
        found: usize,
        /// How many there should be.
        expected: usize,
        /// What they are counted against.
        why: &'static str,
    },
    /// A number outside what makes sense.
    #[error("line {line}: {key} is {found}; {expected}")]
    Value {
        /// Where.
        line: usize,
        /// Which number.
        key: String,
        /// Its value.
        found: String,
        /// What belongs there.
        expected: &'static str,
    },
    /// A key point that says where it is twice, or not at all.
    #[error("line {line}: a key point has either angles_deg or tool, this one has {found}")]
    Place {
        /// Where.
        line: usize,
        /// "both" or "neither".
        found: &'static str,
    },
}
