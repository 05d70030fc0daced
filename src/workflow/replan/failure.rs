//! Why there is no plan for the next run.

use std::path::PathBuf;

use thiserror::Error;

use super::Unclear;
use crate::{
    fit::FitError,
    plan::PlanError,
    series::{JointKind, SignalError},
    units::Degrees,
    workflow::{fit::FitFailure, plan::PlanFailure},
};

/// Why there is no plan for the next run.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ReplanFailure {
    /// No run.
    #[error("found no log, expected at least one run to learn from")]
    NoLog,
    /// Neither plan nor command may change.
    #[error("--keep-plan and --no-precompensation leave nothing to change; drop one of them")]
    NothingToChange,
    /// The runs, or the file with limits.
    #[error(transparent)]
    Fit(#[from] FitFailure),
    /// A prediction.
    #[error("the machine cannot be predicted")]
    Predict(#[from] FitError),
    /// The task.
    #[error(transparent)]
    Task(#[from] PlanFailure),
    /// The task under fitted limits.
    #[error("the task cannot be planned under the limits of the machine")]
    Plan(#[from] PlanError),
    /// Samples that are no track.
    #[error("the plan in the log cannot be sampled")]
    Track(#[from] SignalError),
    /// The plan never moves.
    #[error("the plan in {} never moves; give the log of a run in which it does", path.display())]
    AtRest {
        /// The log.
        path: PathBuf,
    },
    /// The plan was cut.
    #[error(
        "the plan in {} {} at {at_s:.2} s while {joint} moves at {} per second: the log was cut, and no arm {} at \
         once; give the whole log, or with --from and --to a part of it that begins and ends at rest",
        path.display(),
        if *begins { "begins" } else { "ends" },
        Moved(*kind, *speed),
        if *begins { "starts" } else { "stops" }
    )]
    CutInMotion {
        /// The log.
        path: PathBuf,
        /// Whether it is the beginning that is cut off, or the end.
        begins: bool,
        /// The joint.
        joint: String,
        /// Whether it turns or slides.
        kind: JointKind,
        /// Its planned speed there, rad/s or m/s.
        speed: f64,
        /// The first or last planned instant.
        at_s: f64,
    },
    /// Plan or command are silent while a joint moves.
    #[error(
        "the {what} in {} is missing from {:.2} s to {:.2} s while {joint} moves by {}: a command would jump there; give \
         a log without such a hole, or with --from and --to a part of this one",
        path.display(),
        hole_s[0],
        hole_s[1],
        Moved(*kind, *moved)
    )]
    HoleInMotion {
        /// The log.
        path: PathBuf,
        /// Plan or command.
        what: &'static str,
        /// The joint.
        joint: String,
        /// Whether it turns or slides.
        kind: JointKind,
        /// How far it is away after the hole, rad or m.
        moved: f64,
        /// The last instant before it and the first one after it, s.
        hole_s: [f64; 2],
    },
    /// No task to plan.
    #[error(
        "{} holds no task, and only the plan may change; name the task with --task, or leave out --no-precompensation",
        path.display()
    )]
    NoTask {
        /// The log.
        path: PathBuf,
    },
    /// A task of another arm.
    #[error(
        "the task is for the joints {task}, the plan in {} for {log}: give the task of this arm, or leave out --task",
        path.display()
    )]
    OtherArm {
        /// The log.
        path: PathBuf,
        /// Joints of the task.
        task: String,
        /// Joints of the log's plan.
        log: String,
    },
    /// No joint predicted well enough for a command.
    #[error(
        "no joint is predicted well enough for a command: the best held-out R2 is {best:.2}, {least} is needed; {why}"
    )]
    Unpredictable {
        /// The best found.
        best: f64,
        /// The least for commands.
        least: f64,
        /// What may be the reason.
        why: Unclear,
    },
    /// A run that is none of its plan.
    #[error("{}: {why}. No command is made from such a run", path.display())]
    Spoilt {
        /// The log.
        path: PathBuf,
        /// How so.
        why: String,
    },
    /// What was measured has little to do with the plan.
    #[error(
        "{}: half of the joints or more do not follow their plan, the error of each is more than half of its motion, so \
         no command is made; `hydrotrace report` of the log says where sign, zero, unit or name look wrong",
        path.display()
    )]
    Astray {
        /// The log.
        path: PathBuf,
    },
}

/// A distance of a joint as people read it.
struct Moved(JointKind, f64);

impl std::fmt::Display for Moved {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.0 {
            JointKind::Turns => Degrees(self.1).fmt(f),
            JointKind::Slides => write!(f, "{:.1} mm", 1e3 * self.1),
        }
    }
}
