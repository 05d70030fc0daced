//! Why a text is no task.

use std::path::PathBuf;

use thiserror::Error;

/// Why a text is no task; lines count from 1.
#[derive(Debug, Clone, Error, PartialEq)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the message says what each field is")]
pub enum TaskError {
    #[error("cannot read the task {}: {reason}", path.display())]
    Read { path: PathBuf, reason: String },
    #[error("line {line}: {message}")]
    Syntax { line: usize, message: String },
    #[error("line {line}: {key} names the joint {joint:?}; the task's joints are {declared}")]
    UnknownJoint { line: usize, key: String, joint: String, declared: String },
    #[error("line {line}: {key} has no value for the joint {joint:?}; give one for each of {declared}")]
    MissingJoint { line: usize, key: String, joint: String, declared: String },
    #[error(
        "line {line}: {key} names the joint {joint:?}, which line {said} has under {other}; degrees are for a joint that turns, \
         millimetres for one that slides"
    )]
    TwoKinds { line: usize, key: String, joint: String, said: usize, other: String },
    #[error("line {line}: {key} has {found} values, {expected} are needed ({why})")]
    Length { line: usize, key: String, found: usize, expected: usize, why: &'static str },
    #[error("line {line}: {key} is {found}; {expected}")]
    Value { line: usize, key: String, found: String, expected: &'static str },
    #[error(
        "line {line}: a key point has either positions of the joints (angles_deg, positions_mm of those that slide) or tool, this one has {found}"
    )]
    Place { line: usize, found: &'static str },
}
