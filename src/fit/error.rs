//! Why there is no fit, no prediction or no run to make one from.

use thiserror::Error;

use crate::{series::JointKind, text::shell_word, units::Degrees};

/// Why there is no fit, no prediction, or no run to make a fit from.
#[derive(Debug, Clone, Error, PartialEq)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the message says what each field is")]
pub enum FitError {
    #[error(
        "no joint can be fitted: {shared} are both sent and measured ({logs} log(s)), of which none is sent through {} or \
         {} or more; give a log of a run in which joints move",
        Degrees(*least_travel_rad), JointKind::Slides.says(*least_travel_rad)
    )]
    NothingMoves { logs: usize, shared: usize, least_travel_rad: f64 },
    /// What is taken for what was sent stands, though the plan moves.
    #[error(
        "no joint can be fitted: in {log} the plan in {plan} moves, and {command}, what was sent, stands; if that is no set value \
         of the position, --command {} takes the plan for what was sent",
        shell_word(plan)
    )]
    CommandStands { log: String, plan: String, command: String },
    #[error(
        "no joint can be fitted: measured samples are {:.2} s apart, and how a joint answers shows in samples {} s apart or \
         less; record at {:.0} Hz or more",
        interval_s, most_s, most_s.recip()
    )]
    TooSparse { interval_s: f64, most_s: f64 },
    #[error("{key} of joint {joint} is {found}; a number from {least} to {most} is expected")]
    Value { joint: String, key: &'static str, found: f64, least: f64, most: f64 },
    #[error(
        "{log} has the joints {found}, the logs before it {known}: not one in common, so they are of two machines; fit them apart"
    )]
    OtherArm { log: String, found: String, known: String },
    #[error(
        "{joint} turns in one of the logs and slides in another, as in {log}: read all as lengths or all as angles"
    )]
    OtherKind { log: String, joint: String },
    #[error("the fit has no joint {joint}; it has {known}")]
    UnknownJoint { joint: String, known: String },
    #[error("joint {joint} is sent angles for {duration_s} s; at most {most_s} s are simulated")]
    Duration { joint: String, duration_s: f64, most_s: f64 },
    #[error("{key} is {found}; a number from {least} to {most} is expected")]
    Setting { key: &'static str, found: f64, least: f64, most: f64 },
    #[error(
        "joint {joint} starts at {} and may go from {} to {}; a stroke takes {} on one side at least: start elsewhere",
        kind.says(*home_rad), kind.says(*lowest_rad), kind.says(*highest_rad), kind.says(*travel_rad)
    )]
    NoRoom {
        joint: String,
        kind: JointKind,
        home_rad: f64,
        lowest_rad: f64,
        highest_rad: f64,
        travel_rad: f64,
    },
}
