//! The plan of the last run, as far as its log tells it.

use std::path::Path;

use super::{
    Inputs, ReplanFailure,
    samples::{cut, found_at_s, sampled},
};
use crate::{
    log::Recording,
    plan::{PlanError, PlanEvaluation, Setup, Via},
    series::{Broken, Series, Track, bridged, moving_s},
    spline::Motion,
    workflow::{
        carried::{
            Carried,
            rest::{COMMAND_TAIL_S, PLAN_LEAD_S},
        },
        plan::{PlanEntry, PlanRequest, Shaping},
    },
};

/// The last run's plan.
pub(super) struct Last {
    /// Samples, from [`PLAN_LEAD_S`] before the first motion on.
    pub(super) plan: Series,
    /// When the times of the task's plan count from, s.
    pub(super) starts_s: Option<f64>,
    /// From the first to the last motion, s.
    pub(super) duration_s: f64,
    /// The task, if it is known.
    pub(super) request: Option<PlanRequest>,
    /// Arrivals at its key points, s, if they are known and of this task.
    pub(super) times_s: Option<Vec<f64>>,
    /// Free points that it passes between them.
    pub(super) via: Vec<Via>,
    /// Where the controller takes trajectories.
    pub(super) trajectory: Option<String>,
    /// What the log carries of the plan.
    pub(super) carried: Carried,
}

impl Last {
    pub(super) fn of(path: &Path, recording: &Recording, inputs: &Inputs) -> Result<Self, ReplanFailure> {
        let planned = &*bridged(&recording.planned)?;
        let [from_s, to_s] =
            moving_s(planned).ok_or_else(|| ReplanFailure::AtRest { path: path.to_owned() })?;
        let carried = Carried::of(recording).of_plan();
        let request = match (&inputs.task, carried.task_files()) {
            (Some(task), _) => Some(PlanRequest::read(task)?),
            (None, Some(files)) => Some(PlanRequest::of(path, files)?),
            (None, None) => None,
        };
        if let Some(request) = &request {
            check_joints(path, request, planned)?;
        }
        let through = |request: &PlanRequest, entry: &PlanEntry| {
            request.setup.motion_through(&entry.times_s, &entry.via)
        };
        let entry = carried
            .chosen()
            .filter(|entry| request.as_ref().is_some_and(|request| through(request, entry).is_ok()));
        let near_s = from_s - PLAN_LEAD_S;
        let motion = request.as_ref().zip(entry.as_ref());
        // Samples of a log are a little late or early each, which no derivative of them forgives: the motion is exact.
        let exact = match motion.map(|(request, entry)| (&request.setup, through(request, entry))) {
            Some((setup, Ok(motion))) => {
                let plan = sampled(setup, &motion)?;
                found_at_s(&plan, planned, near_s)?.map(|_| plan)
            }
            _ => None,
        };
        let starts_s = match exact {
            Some(_) => Some(PLAN_LEAD_S),
            None => carried.starts_s().map(|s| s - near_s),
        };
        if exact.is_none() {
            let broken =
                Broken::cut(planned, [from_s, to_s]).or_else(|| Broken::hole(planned, [from_s, to_s]));
            whole(path, "plan", broken)?;
        }
        if let Some(command) = &recording.command {
            whole(path, "command", Broken::hole(&*bridged(&command.series)?, [from_s, to_s]))?;
        }
        let (times_s, via) = entry.map(|entry| (entry.times_s, entry.via)).unzip();
        Ok(Self {
            plan: exact.map_or_else(|| cut(planned, near_s, to_s + COMMAND_TAIL_S), Ok)?,
            starts_s,
            duration_s: to_s - from_s,
            request,
            times_s,
            via: via.unwrap_or_default(),
            // A joined log has its plan on our topic.
            trajectory: trajectory_topic(&recording.source.planned_topic)
                .or_else(|| carried.trajectory_topic().and_then(trajectory_topic)),
            carried,
        })
    }

    /// What the plan is free in.
    pub(super) fn shaping(&self) -> Shaping {
        if self.via.is_empty() { Shaping::Timing } else { Shaping::Free(None) }
    }

    /// The motion of the task, if it is known.
    pub(super) fn motion(&self) -> Option<Motion> {
        self.request.as_ref()?.setup.motion_through(self.times_s.as_ref()?, &self.via).ok()
    }

    /// The plan under the limits of a setup, if its times are known.
    pub(super) fn evaluation(&self, setup: &Setup) -> Result<Option<PlanEvaluation>, PlanError> {
        let of = |times_s: &Vec<f64>| PlanEvaluation::through(setup, times_s, &self.via);
        self.times_s.as_ref().map(of).transpose()
    }
}

/// A plan that is broken would be one with a start, a stop or a jump that no arm can make.
fn whole(path: &Path, what: &'static str, broken: Option<Broken>) -> Result<(), ReplanFailure> {
    let path = path.to_owned();
    broken.map_or(Ok(()), |broken| Err(ReplanFailure::Broken { path, what, broken }))
}

/// The task's joints must be in the log, or its timing would be judged on joints that nobody measured.
fn check_joints(path: &Path, request: &PlanRequest, planned: &Series) -> Result<(), ReplanFailure> {
    let task = request.setup.joint_names();
    if task.iter().all(|name| planned.track(name).is_some()) {
        return Ok(());
    }
    let log: Vec<&str> = planned.tracks.iter().map(Track::name).collect();
    Err(ReplanFailure::OtherArm { path: path.to_owned(), task: task.join(", "), log: log.join(", ") })
}

/// Where the controller takes trajectories whose state, or whose last trajectory, the plan was read from.
fn trajectory_topic(planned: &str) -> Option<String> {
    match planned.rsplit_once('/')? {
        // Several controllers take no trajectory of all their joints.
        _ if planned.contains(',') => None,
        ("", _) => None,
        (home, "controller_state" | "state" | "joint_trajectory") => Some(format!("{home}/joint_trajectory")),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn trajectories_go_to_the_controller_that_the_plan_came_from() {
        let found = |topic: &str| trajectory_topic(topic);
        assert_eq!(found("/right/controller_state").as_deref(), Some("/right/joint_trajectory"));
        assert_eq!(found("/a/b/state").as_deref(), Some("/a/b/joint_trajectory"));
        assert_eq!(found("/a/joint_trajectory").as_deref(), Some("/a/joint_trajectory"));
        for unknown in ["/planned/joint_states", "/state", "/a/state, /b/state", "state", ""] {
            assert_eq!(found(unknown), None, "{unknown}");
        }
    }
}
