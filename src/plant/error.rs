//! Why there is no machine, or no run of it.

use std::path::PathBuf;

use thiserror::Error;

use crate::suggest::suggestion;

/// Why there is no machine, or no run of it; lines count from 1.
#[derive(Debug, Clone, Error, PartialEq)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the message says what each field is")]
pub enum PlantError {
    #[error("cannot read the plant {}: {reason}", path.display())]
    Read { path: PathBuf, reason: String },
    #[error("{}: {error}", path.display())]
    File { path: PathBuf, error: Box<PlantError> },
    #[error(
        "{} holds limits that fit found, and no plant: a plant is one of the presets, or a file of dead bands, gains and flows as the guide \
         of simulate shows",
        path.display()
    )]
    Limits { path: PathBuf },
    #[error("line {line}: {message}")]
    Syntax { line: usize, message: String },
    #[error("line {line}: unknown key {key}; {}", match nearest {
        Some(nearest) => format!("is {nearest} meant?"),
        None => "every quantity carries its unit in its key".to_owned(),
    })]
    UnknownKey { line: usize, key: String, nearest: Option<String> },
    #[error("{key} is missing: give a number from {least} to {most}{}", if *by_joint {
        ", or a table with one for each joint"
    } else {
        ""
    })]
    MissingKey { key: String, least: f64, most: f64, by_joint: bool },
    #[error("line {line}: {key} is for {found}; the plant's joints are {declared}")]
    Joints { line: usize, key: String, found: String, declared: String },
    #[error("{}{key} is {found}; {expected}", line.map(|line| format!("line {line}: ")).unwrap_or_default())]
    Value {
        line: Option<usize>,
        key: String,
        /// Its value, in the unit of the key.
        found: f64,
        expected: String,
    },
    #[error(
        "there is no {} {name:?}{}; there are {known}",
        if std::path::Path::new(name).extension().is_some() { "file" } else { "plant" },
        suggestion(nearest.as_deref())
    )]
    UnknownPreset { name: String, nearest: Option<String>, known: String },
    #[error(
        "the plant is for the joints {plant}, the arm has {arm}: give a plant file without base, with these joints in this order \
         and every number; sample-logs/plant/default.toml in the repository is one to start from"
    )]
    OtherArm { plant: String, arm: String },
    #[error("joint {joint} has no cylinder; give it one in the arm's file of cylinders")]
    NoCylinder { joint: String },
    #[error("joint {joint} slides; only arms whose joints all turn are simulated")]
    Slides { joint: String },
    #[error("the command has no {what} for joint {joint}; a track with positions and speeds is needed")]
    NoCommand { joint: String, what: &'static str },
    #[error("the command lasts {duration_s} s; 0 to {most_s} s can be simulated")]
    Duration { duration_s: f64, most_s: f64 },
    #[error(
        "payload change {index} is {mass_kg} kg at {at_s} s; masses of zero or more, in order of time, are expected"
    )]
    Payload { index: usize, mass_kg: f64, at_s: f64 },
    #[error(
        "joint {joint} must hold {force_n:.0} N at the start; the supply gives {least_n:.0} to {most_n:.0} N"
    )]
    TooHeavy { joint: String, force_n: f64, least_n: f64, most_n: f64 },
    /// Springs too stiff or masses too small for the step.
    #[error(
        "joint {joint} would swing at {rate_1_s:.0} 1/s; the step of the simulation allows {most_1_s:.0} 1/s: \
        raise cylinder.dead_volume_m3 or lower friction.bristle_stiffness_n_m or supply.bulk_modulus_pa"
    )]
    TooStiff { joint: String, rate_1_s: f64, most_1_s: f64 },
    #[error("the simulation diverged at {at_s} s; check the arm's masses and the plant's parameters")]
    Diverged { at_s: f64 },
}
