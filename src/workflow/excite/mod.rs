//! `excite`: a run that identifies the parameters that runs of tasks leave open.

use std::{collections::BTreeMap, path::PathBuf};

use thiserror::Error;

use super::{
    carried::{
        Carried, EXCITE, MADE_BY,
        plan_log::{PlanLog, Planned},
    },
    idle_bound::{self, IdleBound},
    plan::{PlanFailure, PlanRequest, TaskFiles},
};
use crate::{
    fit::{Excitation, FitError, JointRoom, RAMP_S, STROKE_POINTS_HZ, excite},
    log::WriteError,
    math::range,
    plan::Setup,
    series::{JointKind, Series, Track},
};

/// The joints to drive.
#[derive(Debug, Clone, PartialEq)]
pub enum Arm {
    /// Those of the sample arm, about where its first task works.
    Sample,
    /// Those of a task's arm, about the middle of its key points.
    Task(PathBuf),
    /// These.
    Joints(Vec<JointRoom>),
}

/// What to write.
#[derive(Debug, Clone, PartialEq)]
pub struct Inputs {
    /// The joints.
    pub arm: Arm,
    /// How to drive them.
    pub excitation: Excitation,
    /// Largest speed that a joint that turns is sent, rad/s; infinite for none.
    pub most_rad_s: f64,
    /// Largest speed that a joint that slides is sent, m/s; infinite for none.
    pub most_m_s: f64,
}

impl Inputs {
    fn most(&self, kind: JointKind) -> f64 {
        if kind == JointKind::Slides { self.most_m_s } else { self.most_rad_s }
    }

    /// Whether every bound has a joint to hold.
    fn check_bounds(&self, joints: &[JointRoom]) -> Result<(), IdleBound> {
        let given = [self.most_rad_s, self.most_m_s].map(f64::is_finite);
        let options = ["--max-speed-deg-s", "--max-speed-mm-s"];
        idle_bound::check("run", given, options, &joints.iter().map(|joint| joint.kind))
    }
}

/// Why there is no such run.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ExciteFailure {
    /// The task.
    #[error(transparent)]
    Task(#[from] PlanFailure),
    /// A bound that no joint is held by.
    #[error(transparent)]
    Bound(#[from] IdleBound),
    /// The joints or the strokes.
    #[error("there is no such run")]
    Run(#[from] FitError),
}

/// The run.
#[derive(Debug, Clone, PartialEq)]
pub struct Excited {
    /// The joints, in the order in which they are driven.
    pub joints: Vec<JointRoom>,
    /// How each is driven.
    pub excitation: Excitation,
    /// What to send.
    pub command: Series,
    /// The task whose arm is driven.
    pub task: Option<TaskFiles>,
    /// Joints that are sent faster than the task allows: what is sent, and what is allowed, rad/s or m/s.
    pub beyond: Vec<(String, JointKind, [f64; 2])>,
    /// The same of accelerations, rad/s² or m/s².
    pub sharper: Vec<(String, JointKind, [f64; 2])>,
}

/// Writes the run.
///
/// # Errors
///
/// [`ExciteFailure`] if the task cannot be read or a joint has no room.
pub fn run(inputs: &Inputs) -> Result<Excited, ExciteFailure> {
    let request = match &inputs.arm {
        Arm::Joints(_) => None,
        Arm::Task(path) => Some(PlanRequest::read(path)?),
        Arm::Sample => Some(PlanRequest::sample()?),
    };
    let joints = match (&inputs.arm, &request) {
        (Arm::Joints(joints), _) => joints.clone(),
        (_, request) => request.as_ref().map_or_else(Vec::new, |request| rooms(&request.setup)),
    };
    inputs.check_bounds(&joints)?;
    let limited = |joint: JointRoom| JointRoom { most_rad_s: inputs.most(joint.kind), ..joint };
    let joints: Vec<JointRoom> = joints.into_iter().map(limited).collect();
    let excitation = inputs.excitation.clone();
    let command = excite(&joints, &excitation)?;
    let of = |limit: usize, sent: fn(&Track) -> f64| {
        request.as_ref().map_or_else(Vec::new, |request| beyond(&request.setup, &command, limit, sent))
    };
    let (beyond, sharper) = (of(1, fastest_rad_s), of(2, sharpest_rad_s2));
    Ok(Excited { joints, excitation, command, task: request.map(|request| request.files), beyond, sharper })
}

fn fastest_rad_s(track: &Track) -> f64 {
    track.velocity().unwrap_or_default().iter().fold(0.0, |most, speed| most.max(speed.abs()))
}

/// Strokes take [`RAMP_S`] to their speed, evenly.
fn sharpest_rad_s2(track: &Track) -> f64 {
    fastest_rad_s(track) / RAMP_S
}

/// What is sent at a limit lies beyond it by less.
const ROUNDING: f64 = 1e-9;

/// Joints that are sent beyond one of their limits: of the angle's derivative of this order.
fn beyond(
    setup: &Setup,
    command: &Series,
    limit: usize,
    sent: impl Fn(&Track) -> f64,
) -> Vec<(String, JointKind, [f64; 2])> {
    let of_joint = |(j, name): (usize, String)| {
        // Strokes go both ways alike.
        let [low, high] = *setup.joint_limits(j)?.get(limit)?;
        let most = high.min(-low);
        let track = command.track(&name)?;
        let sent = sent(track);
        (sent > (1.0 + ROUNDING) * most).then_some((name, track.kind(), [sent, most]))
    };
    setup.joint_names().into_iter().enumerate().filter_map(of_joint).collect()
}

/// Every joint about the middle of what its key points ask for, within its range.
fn rooms(setup: &Setup) -> Vec<JointRoom> {
    let points = setup.template().points();
    let of_joint = |(j, (name, kind)): (usize, (String, JointKind))| {
        let [least, most] = range((0..points.len()).map(|point| points.of(point)[j]));
        let (home_rad, range_rad) = (0.5 * (least + most), setup.range_rad(j));
        JointRoom { name, kind, home_rad, range_rad, most_rad_s: f64::INFINITY }
    };
    setup.joint_names().into_iter().zip(setup.joint_kinds()).enumerate().map(of_joint).collect()
}

impl Excited {
    /// How long it takes, s.
    pub fn duration_s(&self) -> f64 {
        self.command.span_s().map_or(0.0, |[_, end_s]| end_s)
    }

    /// Largest speed of any joint of a kind, rad/s or m/s; zero without one.
    pub fn fastest(&self, kind: JointKind) -> f64 {
        let own = self.command.tracks.iter().filter(|track| track.kind() == kind);
        own.map(fastest_rad_s).fold(0.0, f64::max)
    }

    /// The bytes of the log.
    ///
    /// # Errors
    ///
    /// [`WriteError`] for joint names that no log can hold.
    pub fn log(&self, rate_hz: f64) -> Result<Vec<u8>, WriteError> {
        // So that whoever runs it knows its arm.
        let carried =
            self.task.as_ref().map_or_else(Carried::default, |task| Carried::default().with_arm_of(task));
        let carried = carried.with_provenance(BTreeMap::from([(MADE_BY.to_owned(), EXCITE.to_owned())]));
        PlanLog {
            plan: Planned::Series(&self.command),
            command: None,
            arm: None,
            trajectory: None,
            carried: &carried,
            rate_hz,
            points_hz: STROKE_POINTS_HZ,
        }
        .bytes()
    }
}
