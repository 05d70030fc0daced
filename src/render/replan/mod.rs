//! What was planned again.

mod learning;
mod tables;

pub(crate) use tables::document;

use crate::{plan::Limit, workflow::replan::Replanned};

/// Name of a joint of the task's arm.
fn joint_name(replanned: &Replanned, joint: Option<usize>) -> Option<String> {
    replanned.request.as_ref()?.setup.joint_names().into_iter().nth(joint?)
}

/// The limits that a command is held against.
const OF_COMMAND: [Limit; 5] =
    [Limit::Position, Limit::Speed, Limit::Acceleration, Limit::Jerk, Limit::RodSpeed];
