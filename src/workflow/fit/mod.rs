//! `fit`: from logs of runs to what the machine does with what it is sent.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use thiserror::Error;

pub mod observe;
pub mod torque;

use crate::{
    fit::{Fit, FitError, Observation, fit},
    log::{ReadOptions, Recording, SignalRole, SourceInfo},
    remark::{Code, Remarks},
    series::Track,
};
use {
    observe::{ObserveFailure, observation, observe},
    torque::{JointTorque, torques},
};

/// What to fit.
#[derive(Debug, Clone, Default)]
pub struct Inputs {
    /// Runs, each a file or a bag directory.
    pub logs: Vec<PathBuf>,
    /// What to read of each.
    pub read: ReadOptions,
}

/// Why there is no fit.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum FitFailure {
    /// A log.
    #[error(transparent)]
    Observe(#[from] ObserveFailure),
    /// What the logs hold.
    #[error("the logs cannot be fitted")]
    Fit(#[from] FitError),
    /// A file with limits cannot be read.
    #[error("cannot read {}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A file is no limits.
    #[error("{} does not hold limits; `hydrotrace fit LOG -o FILE` writes some", path.display())]
    Limits {
        /// The file.
        path: PathBuf,
        /// Line and reason.
        source: Box<toml::de::Error>,
    },
    /// A file of another kind or of a later version.
    #[error("{} is of format {found:?}, expected {FORMAT:?}", path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// What it says.
        found: String,
    },
    /// A file of another arm.
    #[error("the limits in {} are of the joints {found}, the log has {expected}: not one in common", path.display())]
    OtherJoints {
        /// The file.
        path: PathBuf,
        /// Its joints.
        found: String,
        /// Those of the log.
        expected: String,
    },
    /// Numbers in a file that no machine has.
    #[error("the limits in {} cannot be used", path.display())]
    Values {
        /// The file.
        path: PathBuf,
        /// Which.
        source: FitError,
    },
}

/// First line of every file with limits.
pub const FORMAT: &str = "hydrotrace.limits.v1";

/// A file with limits, TOML.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LimitsFile {
    /// Always [`FORMAT`].
    pub format: String,
    /// Names of the logs that were fitted.
    pub logs: Vec<String>,
    /// Torques from pressures, where the logs have them.
    #[serde(default)]
    pub torques: Vec<JointTorque>,
    /// What was found.
    #[serde(flatten)]
    pub fit: Fit,
}

/// A run that was fitted.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct FittedRun {
    /// Name of its log.
    pub log: String,
    /// Where plan and measurement come from.
    pub source: SourceInfo,
    /// Whether a command beside the plan was taken as what was sent.
    pub commanded: bool,
    /// Whether signals to the valves were read.
    pub valves: bool,
}

/// A fit, and what it was made from.
#[derive(Debug, Clone, PartialEq)]
pub struct Fitted {
    /// The machine.
    pub fit: Fit,
    /// Torques by joint, of the first run that has pressures and a task with cylinders.
    pub torques: Vec<JointTorque>,
    /// The runs.
    pub runs: Vec<FittedRun>,
    /// Doubts about the data.
    pub remarks: Remarks,
}

/// Reads and fits all runs at once.
///
/// # Errors
///
/// [`FitFailure`] naming the log.
pub fn run(inputs: &Inputs) -> Result<Fitted, FitFailure> {
    let observed = observed(&inputs.logs, &inputs.read)?;
    Ok(of(&inputs.logs, &observed)?)
}

/// Reads runs.
///
/// # Errors
///
/// [`ObserveFailure`] naming the log.
pub fn observed(logs: &[PathBuf], read: &ReadOptions) -> Result<Vec<Recording>, ObserveFailure> {
    logs.iter().map(|path| observe(path, read)).collect()
}

/// Fits runs that were read from these logs.
///
/// # Errors
///
/// [`FitError`] if no joint can be fitted.
pub fn of(logs: &[PathBuf], observed: &[Recording]) -> Result<Fitted, FitError> {
    of_one_arm(logs, observed)?;
    let observations: Vec<Observation<'_>> = observed.iter().map(observation).collect();
    let fit = fit(&observations)?;
    for joint in &fit.joints {
        ::log::info!(
            "{} fitted to {} samples in {} runs; {:e} rad unexplained, held-out R2 {:.3}",
            joint.name,
            joint.samples,
            joint.runs,
            joint.residual_rad,
            joint.held_out_r2
        );
    }
    let mut remarks = Remarks::default();
    let mut runs = Vec::new();
    for (path, observed) in logs.iter().zip(observed) {
        let log = name(path);
        // A machine is fitted to what was sent, whatever was planned.
        let doubts = observed.remarks.clone().without(Code::PlanIsCommand);
        for remark in doubts.as_slice() {
            let message =
                if logs.len() > 1 { format!("{log}: {}", remark.message) } else { remark.message.clone() };
            remarks.add(remark.code, remark.count, message);
        }
        runs.push(FittedRun {
            log,
            source: observed.source.clone(),
            commanded: observed.command.is_some(),
            valves: observed.has(SignalRole::Valve),
        });
    }
    for joint in fit.joints.iter().filter(|joint| !joint.trusted()) {
        let message = format!(
            "{} is predicted with a held-out R2 of {:.2}, less than {}: no command is made for it",
            joint.name,
            joint.held_out_r2,
            crate::fit::LEAST_SKILL
        );
        remarks.add(Code::PoorFit, 1, message);
    }
    let torques = logs.iter().zip(observed).map(|(path, observed)| torques(path, observed));
    let torques = torques.into_iter().find(|torques| !torques.is_empty()).unwrap_or_default();
    Ok(Fitted { fit, torques, runs, remarks })
}

/// Every log must share a joint with those before it: a machine is fitted, not several.
fn of_one_arm(logs: &[PathBuf], observed: &[Recording]) -> Result<(), FitError> {
    let mut known: Vec<&str> = Vec::new();
    for (path, observed) in logs.iter().zip(observed) {
        let own: Vec<&str> = observed.measured.tracks.iter().map(Track::name).collect();
        if !known.is_empty() && !own.iter().any(|name| known.contains(name)) {
            let (found, known) = (own.join(", "), known.join(", "));
            return Err(FitError::OtherArm { log: name(path), found, known });
        }
        known.extend(own.into_iter().filter(|name| !known.contains(name)).collect::<Vec<_>>());
    }
    Ok(())
}

impl LimitsFile {
    /// Checks that a log is of the machine, or of one that shares a joint with it.
    ///
    /// # Errors
    ///
    /// [`FitFailure::OtherJoints`].
    pub fn check_joints<'a>(
        &self,
        path: &Path,
        joints: impl Iterator<Item = &'a str> + Clone,
    ) -> Result<(), FitFailure> {
        if joints.clone().any(|name| self.fit.joint(name).is_some()) {
            return Ok(());
        }
        let found: Vec<&str> = self.fit.joints.iter().map(|joint| joint.name.as_str()).collect();
        let (found, expected) = (found.join(", "), joints.collect::<Vec<_>>().join(", "));
        Err(FitFailure::OtherJoints { path: path.to_owned(), found, expected })
    }
}

/// The file's own name.
fn name(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}

impl Fitted {
    /// As a file that [`read_limits`] reads.
    pub fn file(&self) -> LimitsFile {
        let logs = self.runs.iter().map(|run| run.log.clone()).collect();
        let torques = self.torques.clone();
        LimitsFile { format: FORMAT.to_owned(), logs, torques, fit: self.fit.clone() }
    }
}

/// Reads a file with limits.
///
/// # Errors
///
/// [`FitFailure`] naming the file, and the line or joint.
pub fn read_limits(path: &Path) -> Result<LimitsFile, FitFailure> {
    let path = path.to_owned();
    let text = match std::fs::read_to_string(&path) {
        Ok(text) => text,
        Err(source) => return Err(FitFailure::Read { path, source }),
    };
    let file: LimitsFile = match toml::from_str(&text) {
        Ok(file) => file,
        Err(source) => return Err(FitFailure::Limits { path, source: Box::new(source) }),
    };
    if file.format != FORMAT {
        return Err(FitFailure::Format { path, found: file.format });
    }
    match file.fit.check() {
        Ok(()) => Ok(file),
        Err(source) => Err(FitFailure::Values { path, source }),
    }
}
