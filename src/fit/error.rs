//! Why there is no fit, no prediction or no run to make one from.

use thiserror::Error;

use crate::units::Degrees;

/// Why there is no fit, no prediction, or no run to make a fit from.
#[derive(Debug, Clone, Error, PartialEq)]
#[non_exhaustive]
pub enum FitError {
    /// No joint has enough motion.
    #[error(
        "no joint can be fitted: of joints that turn, {shared} are both sent and measured ({logs} log(s)), of which none \
         is sent through {} or more; give a log of a run in which such joints move",
        Degrees(*least_travel_rad)
    )]
    NothingMoves {
        /// Number of logs.
        logs: usize,
        /// Joints that are sent and measured in one of them.
        shared: usize,
        /// What counts as motion.
        least_travel_rad: f64,
    },
    /// Joints move, but are not sampled often enough to show how.
    #[error(
        "no joint can be fitted: measured samples are {:.2} s apart, and how a joint answers shows in samples {} s apart or \
         less; record at {:.0} Hz or more",
        interval_s, most_s, most_s.recip()
    )]
    TooSparse {
        /// Mean distance of the samples of the joint that has most of them, s.
        interval_s: f64,
        /// What is needed, s.
        most_s: f64,
    },
    /// A number of a model that cannot be.
    #[error("{key} of joint {joint} is {found}; a number from {least} to {most} is expected")]
    Value {
        /// The joint.
        joint: String,
        /// Which number.
        key: &'static str,
        /// Its value.
        found: f64,
        /// Smallest value.
        least: f64,
        /// Largest value.
        most: f64,
    },
    /// Logs of different arms.
    #[error(
        "{log} has the joints {found}, the logs before it {known}: not one in common, so they are of two machines; fit them apart"
    )]
    OtherArm {
        /// The log.
        log: String,
        /// Its joints.
        found: String,
        /// Those of the logs before it.
        known: String,
    },
    /// A joint that the fit leaves out.
    #[error("the fit has no joint {joint}; it has {known}")]
    UnknownJoint {
        /// The joint.
        joint: String,
        /// Joints of the fit.
        known: String,
    },
    /// A plan longer than a simulation may be.
    #[error("joint {joint} is sent angles for {duration_s} s; at most {most_s} s are simulated")]
    Duration {
        /// The joint.
        joint: String,
        /// From its first to its last sample.
        duration_s: f64,
        /// The longest.
        most_s: f64,
    },
    /// A setting of the compensation out of range.
    #[error("{key} is {found}; a number from {least} to {most} is expected")]
    Setting {
        /// Which.
        key: &'static str,
        /// Its value.
        found: f64,
        /// Smallest value.
        least: f64,
        /// Largest value.
        most: f64,
    },
    /// A joint without room for the run.
    #[error(
        "joint {joint} starts at {} and may go from {} to {}; a stroke takes {} on one side at least: start elsewhere",
        Degrees(*home_rad), Degrees(*lowest_rad), Degrees(*highest_rad), Degrees(*travel_rad)
    )]
    NoRoom {
        /// The joint.
        joint: String,
        /// Where it starts.
        home_rad: f64,
        /// Its lowest angle.
        lowest_rad: f64,
        /// Its highest angle.
        highest_rad: f64,
        /// What was asked for.
        travel_rad: f64,
    },
}
