//! The plan of the last run, as far as its log tells it.

use std::path::Path;

use super::{
    Inputs, ReplanFailure,
    hole::{bridged, check_holes},
    samples::{cut, found_at_s, sampled},
};
use crate::{
    log::Recording,
    plan::{PlanError, PlanEvaluation, Setup, Via},
    series::{Series, Track},
    spline::Motion,
    units::DEGREE_RAD,
    workflow::{
        carried::{
            Carried,
            rest::{COMMAND_TAIL_S, PLAN_LEAD_S},
        },
        plan::{PlanEntry, PlanRequest, Shaping},
    },
};

/// Planned speed that is motion, rad/s, or m/s of joints that slide.
const MOVES: f64 = 0.05 * DEGREE_RAD;

/// Planned speed at which a plan does not end, rad/s or m/s, and how close to its end that is looked for, s.
const CUT_SPEED: f64 = DEGREE_RAD;
const CUT_S: f64 = 0.05;

/// The longest time without a plan within one motion, s.
const LONGEST_HOLE_S: f64 = 60.0;

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
        let planned = &bridged(&recording.planned)?;
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
            check_ends(path, planned, [from_s, to_s])?;
            check_holes(path, "plan", planned, [from_s, to_s])?;
        }
        if let Some(command) = &recording.command {
            check_holes(path, "command", &bridged(&command.series)?, [from_s, to_s])?;
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

/// A plan that was cut in its motion would be one with a start or a stop that no arm can make.
fn check_ends(path: &Path, planned: &Series, [from_s, to_s]: [f64; 2]) -> Result<(), ReplanFailure> {
    for track in &planned.tracks {
        let (t_s, position) = (track.t_s(), track.position());
        let first = t_s.partition_point(|t| *t < from_s - CUT_S);
        let last = t_s.partition_point(|t| *t <= to_s + CUT_S).saturating_sub(1);
        let begins = track.segments().iter().any(|part| part.start == first && part.len() > 1);
        let ends = track.segments().iter().any(|part| part.end == last + 1 && part.len() > 1);
        // An end, its neighbour, and where the motion has its own.
        let first = (first, first + 1, from_s, true);
        let last = (last, last.wrapping_sub(1), to_s, false);
        let ends = [first].into_iter().filter(|_| begins).chain([last].into_iter().filter(|_| ends));
        for (at, next, _, begins) in ends.filter(|(at, _, end_s, _)| (t_s[*at] - end_s).abs() <= CUT_S) {
            let step = (position[at] - position[next]) / (t_s[at] - t_s[next]);
            let speed = track.velocity().map_or(step, |speed| speed[at]);
            if speed.abs() > CUT_SPEED {
                let (path, joint, kind) = (path.to_owned(), track.name().to_owned(), track.kind());
                return Err(ReplanFailure::CutInMotion { path, begins, joint, kind, speed, at_s: t_s[at] });
            }
        }
    }
    Ok(())
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

/// When the first joint starts to move and the last one stops, s, in the newest part of the log in which one moves.
pub(super) fn moving_s(series: &Series) -> Option<[f64; 2]> {
    parts_s(series).into_iter().rev().find_map(|part_s| moving_within_s(series, part_s))
}

/// Parts of a log with holes between them in which no joint has a plan: a clock was set, or recording paused. What
/// lies on two sides of one is not one motion.
fn parts_s(series: &Series) -> Vec<[f64; 2]> {
    let span = |track: &Track| {
        let t_s = track.t_s().to_vec();
        track.segments().iter().map(move |part| [t_s[part.start], t_s[part.end - 1]]).collect::<Vec<_>>()
    };
    let mut all: Vec<[f64; 2]> = series.tracks.iter().flat_map(span).collect();
    all.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut parts: Vec<[f64; 2]> = Vec::new();
    for [from_s, to_s] in all {
        match parts.last_mut() {
            Some(part) if from_s - part[1] <= LONGEST_HOLE_S => part[1] = part[1].max(to_s),
            _ => parts.push([from_s, to_s]),
        }
    }
    parts
}

fn moving_within_s(series: &Series, [begin_s, end_s]: [f64; 2]) -> Option<[f64; 2]> {
    let mut found: Option<[f64; 2]> = None;
    for track in &series.tracks {
        let (t_s, angle_rad) = (track.t_s(), track.position());
        let within = t_s.partition_point(|t| *t < begin_s)..t_s.partition_point(|t| *t <= end_s);
        let moving = |k: usize| {
            let fast = track.velocity().is_some_and(|speed| speed[k].abs() > MOVES);
            fast || (k > within.start
                && (angle_rad[k] - angle_rad[k - 1]).abs() > MOVES * (t_s[k] - t_s[k - 1]).max(1e-3))
        };
        let first = within.clone().find(|&k| moving(k));
        let last = within.clone().rev().find(|&k| moving(k));
        if let (Some(first), Some(last)) = (first, last) {
            let [from, to] = found.unwrap_or([f64::INFINITY, f64::NEG_INFINITY]);
            found = Some([from.min(t_s[first]), to.max(t_s[last])]);
        }
    }
    found
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
