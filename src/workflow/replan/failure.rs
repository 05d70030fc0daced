//! Why there is no plan for the next run.

use std::path::{Path, PathBuf};

use thiserror::Error;

use super::Unclear;
use crate::{
    fit::FitError,
    plan::PlanError,
    series::{Broken, JointKind, SignalError},
    workflow::{correctable::Uncorrectable, fit::FitFailure, idle_bound::IdleBound, plan::PlanFailure},
};

/// Why there is no plan for the next run.
#[derive(Debug, Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the message says what each field is")]
pub enum ReplanFailure {
    #[error("found no log, expected at least one run to learn from")]
    NoLog,
    #[error("--keep-plan and --no-precompensation leave nothing to change; drop one of them")]
    NothingToChange,
    #[error("{key} is {found}; a share from 0 to {most} is expected")]
    Growth { key: &'static str, found: f64, most: f64 },
    #[error(transparent)]
    Fit(#[from] FitFailure),
    #[error("the machine cannot be predicted")]
    Predict(#[from] FitError),
    #[error(transparent)]
    Task(#[from] PlanFailure),
    #[error("the task cannot be planned under the limits of the machine")]
    Plan(#[from] PlanError),
    #[error("the plan in the log cannot be sampled")]
    Track(#[from] SignalError),
    #[error("the plan in {} never moves; give the log of a run in which it does", path.display())]
    AtRest { path: PathBuf },
    #[error("the {what} in {} {}", path.display(), Said(broken))]
    Broken { path: PathBuf, what: &'static str, broken: Broken },
    #[error(
        "{} holds no task, and only the plan may change; name the task with --task, or leave out --no-precompensation",
        path.display()
    )]
    NoTask { path: PathBuf },
    #[error(
        "no timing of the task is found within the time, jerk and power of the plan in {}, and that is no plan of the task: {missed}; \
         allow more with --max-time-growth-percent and --max-cost-growth-percent, or plan the task anew with hydrotrace plan",
        path.display()
    )]
    NoWay { path: PathBuf, missed: String },
    #[error(transparent)]
    IdleBound(#[from] IdleBound),
    #[error(
        "the plan in {} begins {} beside the first key point of the task ({joint}): the arm would jump there; give the task of \
         this plan, or leave out --task",
        path.display(),
        kind.says(*far)
    )]
    OtherStart {
        path: PathBuf,
        joint: String,
        kind: JointKind,
        /// By how much, rad.
        far: f64,
    },
    #[error(
        "the task is for the joints {task}, the plan in {} for {log}: give the task of this arm, or leave out --task",
        path.display()
    )]
    OtherArm { path: PathBuf, task: String, log: String },
    #[error(
        "the task in {} is for the joints {task}, and only {log} is read: leave out --joints, or keep the plan with --keep-plan",
        path.display()
    )]
    SomeJoints { path: PathBuf, task: String, log: String },
    #[error(
        "no joint is predicted well enough for a command: the best held-out R2 is {best:.2}, {least} is needed; {why}"
    )]
    Unpredictable { best: f64, least: f64, why: Unclear },
    #[error(
        "the plan in {} is that of {other} and a correction of what that run was off by: it seems to be what was sent, and the arm is to \
         follow the plan behind it; one more correction would lead farther away from that. `hydrotrace join LOG --plan next.mcap -o with-plan.mcap` \
         puts the plan into the log, from the file that replan wrote for that run; if it is a plan of its own, give its log alone",
        path.display()
    )]
    SentAsPlan { path: PathBuf, other: String },
    #[error("{}: {why}. No command is made from such a run; leave it out if there are others", path.display())]
    Spoilt { path: PathBuf, why: String },
    /// A plan that ends in the middle of the motion that another log has.
    #[error(
        "the plan of the last log is that of {log} for {after_s:.1} s from its first motion on, and breaks off there: the run was stopped, and no arm stops at \
         once; leave the last log out, or, if its plan is meant, {log}"
    )]
    BreaksOff { log: String, after_s: f64 },
    /// A log that ends or begins within a plan that another log has as a whole.
    #[error(
        "{log} {} the plan of {other} does, which {}: the command would be of a part of the task; leave {log} out, or, if that part \
         is meant, {other}",
        if *ends { "ends before" } else { "begins after" },
        if *ends { "moves on after it" } else { "moves before it" }
    )]
    InRest { log: String, other: String, ends: bool },
    /// A plan that no joint can follow, whatever is sent.
    #[error(
        "{}: the plan of {joint} steps by {size} at {at_s:.2} s: no joint follows a step, and a correction would only \
         move it before its time, so no command is made. Give the joint ramps that it can follow: `hydrotrace plan` makes \
         some, or set those of the controller and log its ramped set value as the plan. `hydrotrace report` tells delay, \
         overshoot and settling of steps, and `hydrotrace fit` the fastest speed for the ramps",
        path.display()
    )]
    Steps { path: PathBuf, joint: String, size: String, at_s: f64 },
    #[error(
        "{}: the plan of {joint} goes from one end of its turn to the other at {at_s:.2} s: a joint that turns on, whose angles wrap; \
         say so with --continuous {joint}",
        path.display()
    )]
    Wraps { path: PathBuf, joint: String, at_s: f64 },
    #[error(
        "{}: its plan is an identification run, which shows limits by strokes that the machine cannot follow, and no command \
         corrects that; `hydrotrace fit` learns from it, give this command the log of a task",
        path.display()
    )]
    Identifies { path: PathBuf },
    #[error(
        "{}: half of the joints or more do not follow their plan, the error of each is more than half of its motion, so \
         no command is made; `hydrotrace report` of the log says where sign, zero, unit or name look wrong, and whether its plan is \
         faster than the joints go: then a slower one is needed (hydrotrace replan without --keep-plan, or hydrotrace plan)",
        path.display()
    )]
    Astray { path: PathBuf },
}

impl ReplanFailure {
    /// Of a plan that no command is corrected for.
    pub(super) fn of(path: &Path, why: Uncorrectable) -> Self {
        let path = path.to_owned();
        match why {
            Uncorrectable::Identifies => Self::Identifies { path },
            Uncorrectable::Wraps { joint, at_s } => Self::Wraps { path, joint, at_s },
            Uncorrectable::Steps { joint, size, at_s } => Self::Steps { path, joint, size, at_s },
        }
    }
}

/// Where a plan or command is broken, what that means, and what to give.
struct Said<'a>(&'a Broken);

impl std::fmt::Display for Said<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}: ", self.0)?;
        match self.0 {
            Broken::Cut { begins, .. } => write!(
                f,
                "the log was cut, and no arm {} at once; give the whole log (`hydrotrace join` makes one of parts), or with --from and \
                 --to a part of it that begins and ends at rest",
                if *begins { "starts" } else { "stops" }
            ),
            Broken::Halted { .. } => write!(
                f,
                "the run was stopped there, and no arm stops at once; leave the log out and give one of a whole run, or cut that out of \
                 this one with --from and --to"
            ),
            Broken::Hole { .. } => write!(
                f,
                "a command would jump there; give a log without such a hole, or with --from and --to a part of this one"
            ),
        }
    }
}
