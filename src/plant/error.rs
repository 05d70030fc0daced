//! Why there is no machine, or no run of it.

use std::path::PathBuf;

use thiserror::Error;

use crate::suggest::suggestion;

/// Why there is no machine, or no run of it; lines count from 1.
#[derive(Debug, Clone, Error, PartialEq)]
#[non_exhaustive]
pub enum PlantError {
    /// The file cannot be read.
    #[error("cannot read the plant {}: {reason}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        reason: String,
    },
    /// The text is no TOML, or has a table that no plant has.
    #[error("line {line}: {message}")]
    Syntax {
        /// Where.
        line: usize,
        /// What is wrong.
        message: String,
    },
    /// A key that no plant has.
    #[error("line {line}: unknown key {key}; {}", match nearest {
        Some(nearest) => format!("is {nearest} meant?"),
        None => "every quantity carries its unit in its key".to_owned(),
    })]
    UnknownKey {
        /// Where.
        line: usize,
        /// The key.
        key: String,
        /// One that is spelt alike.
        nearest: Option<String>,
    },
    /// A key that is left out.
    #[error("{key} is missing: give a number from {least} to {most}{}", if *by_joint {
        ", or a table with one for each joint"
    } else {
        ""
    })]
    MissingKey {
        /// The key.
        key: String,
        /// Smallest value.
        least: f64,
        /// Largest value.
        most: f64,
        /// Whether joints may differ.
        by_joint: bool,
    },
    /// Joints that are left out or unknown.
    #[error("line {line}: {key} is for {found}; the plant's joints are {declared}")]
    Joints {
        /// Where.
        line: usize,
        /// The key.
        key: String,
        /// The joints that it names.
        found: String,
        /// The joints of the plant.
        declared: String,
    },
    /// A number outside what makes sense.
    #[error("{}{key} is {found}; {expected}", line.map(|line| format!("line {line}: ")).unwrap_or_default())]
    Value {
        /// Where, if it comes from a file.
        line: Option<usize>,
        /// Which number.
        key: String,
        /// Its value, in the unit of the key.
        found: f64,
        /// What belongs there.
        expected: String,
    },
    /// No such machine comes with the program.
    #[error("there is no plant {name:?}{}; there are {known}", suggestion(nearest.as_deref()))]
    UnknownPreset {
        /// What was asked for.
        name: String,
        /// One of nearly that name.
        nearest: Option<String>,
        /// What there is.
        known: String,
    },
    /// Plant and arm do not belong together.
    #[error(
        "the plant is for the joints {plant}, the arm has {arm}: give a plant file with these joints in this order; \
         sample-logs/plant/default.toml in the repository is one to start from"
    )]
    OtherArm {
        /// Joints of the plant.
        plant: String,
        /// Joints of the arm.
        arm: String,
    },
    /// A joint that nothing moves.
    #[error("joint {joint} has no cylinder; give it one in the arm's file of cylinders")]
    NoCylinder {
        /// The joint.
        joint: String,
    },
    /// A joint that the command leaves out.
    #[error("the command has no {what} for joint {joint}; a track with positions and speeds is needed")]
    NoCommand {
        /// The joint.
        joint: String,
        /// "track" or "speeds".
        what: &'static str,
    },
    /// A run longer than a simulation can be.
    #[error("the command lasts {duration_s} s; 0 to {most_s} s can be simulated")]
    Duration {
        /// Its end.
        duration_s: f64,
        /// The longest.
        most_s: f64,
    },
    /// A payload that cannot be.
    #[error(
        "payload change {index} is {mass_kg} kg at {at_s} s; masses of zero or more, in order of time, are expected"
    )]
    Payload {
        /// Which change.
        index: usize,
        /// The mass.
        mass_kg: f64,
        /// The time.
        at_s: f64,
    },
    /// A start at which the supply cannot hold the arm.
    #[error(
        "joint {joint} must hold {force_n:.0} N at the start; the supply gives {least_n:.0} to {most_n:.0} N"
    )]
    TooHeavy {
        /// The joint.
        joint: String,
        /// What gravity asks of its cylinders, positive to push.
        force_n: f64,
        /// Largest pull, negative.
        least_n: f64,
        /// Largest push.
        most_n: f64,
    },
    /// Springs too stiff or masses too small for the step.
    #[error(
        "joint {joint} would swing at {rate_1_s:.0} 1/s; the step of the simulation allows {most_1_s:.0} 1/s: \
        raise cylinder.dead_volume_m3 or lower friction.bristle_stiffness_n_m or supply.bulk_modulus_pa"
    )]
    TooStiff {
        /// The joint.
        joint: String,
        /// Angular frequency of oil and bristles against the joint's inertia.
        rate_1_s: f64,
        /// The largest.
        most_1_s: f64,
    },
    /// The state left the numbers.
    #[error("the simulation diverged at {at_s} s; check the arm's masses and the plant's parameters")]
    Diverged {
        /// When.
        at_s: f64,
    },
}
