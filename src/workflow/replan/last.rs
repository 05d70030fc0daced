//! The plan of the last run, as far as its log tells it.

use std::path::Path;

use super::{Inputs, ReplanFailure, samples::sampled};
use crate::{
    arm::Arm,
    log::Recording,
    plan::{PlanError, PlanEvaluation, Setup, Via},
    remark::{Code, Remarks},
    series::{Broken, Series, Track, bridged, moving_s},
    spline::Motion,
    units::DEGREE_RAD,
    workflow::{
        carried::{
            Carried,
            rest::{COMMAND_TAIL_S, PLAN_LEAD_S},
        },
        plan::{PlanEntry, PlanRequest, Shaping},
        same_plan::{cut, found_at_s},
    },
};

/// A joint that is so near its rest is there, rad or m; how long one may creep before it is called motion, and by what
/// steps that is looked for, s.
const AT_REST: f64 = 1e-3 * DEGREE_RAD;
const MOST_CREEP_S: f64 = 10.0;
const CREEP_STEP_S: f64 = 0.1;

/// A joint that has left its rest by more creeps, rad or m, at the least; its rest is looked at over so many steps of so long, s.
const CREPT: f64 = 1e-6 * DEGREE_RAD;
const WAVERS: u32 = 20;
const CREPT_STEP_S: f64 = 0.01;

/// Instants at which a plan is looked at for key points, which it misses by so much at least, rad.
const INSTANTS: u32 = 4000;
const MISSES_RAD: f64 = 2.0 * DEGREE_RAD;

/// The last run's plan.
pub(super) struct Last {
    /// Samples, from [`PLAN_LEAD_S`] before the first motion on.
    pub(super) plan: Series,
    /// When the times of the task's plan count from, s.
    pub(super) starts_s: Option<f64>,
    /// From where it leaves its first rest to where it has come to its last, s.
    pub(super) duration_s: f64,
    /// The same, as instants of the log.
    pub(super) span_s: [f64; 2],
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
    /// Key points of a task that was given which the plan does not pass.
    pub(super) elsewhere: Vec<String>,
}

impl Last {
    /// The arm of its task.
    pub(super) fn arm(&self) -> Option<&Arm> {
        self.request.as_ref().map(|request| request.setup.arm())
    }

    pub(super) fn of(path: &Path, recording: &Recording, inputs: &Inputs) -> Result<Self, ReplanFailure> {
        let planned = &*bridged(&recording.planned)?;
        let [from_s, to_s] =
            moving_s(planned).ok_or_else(|| ReplanFailure::AtRest { path: path.to_owned() })?;
        let [from_s, to_s] = rests_s(planned, [from_s, to_s]);
        let carried = Carried::of(recording).of_plan();
        let request = match (&inputs.task, carried.task_files()) {
            (Some(task), _) => Some(PlanRequest::read(task)?),
            // A command for some of the arm's joints alone takes nothing from its task.
            (None, Some(files)) => Some(PlanRequest::of(path, files)?)
                .filter(|request| !inputs.keep_plan || has_joints(request, planned)),
            (None, None) => None,
        };
        let mut elsewhere = Vec::new();
        if let Some(request) = &request {
            check_joints(path, request, planned, inputs.task.is_none())?;
            if inputs.task.is_some() {
                elsewhere = check_points(path, request, planned, [from_s, to_s])?;
            }
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
            let span_s = [from_s, to_s];
            let broken = Broken::cut(planned, span_s).or_else(|| Broken::hole(planned, span_s));
            let broken = broken.or_else(|| Broken::halt(planned, span_s));
            whole(path, "plan", broken)?;
        }
        if let Some(command) = &recording.command {
            whole(path, "command", Broken::hole(&*bridged(&command.series)?, [from_s, to_s]))?;
        }
        let (times_s, via) = entry.map(|entry| (entry.times_s, entry.via)).unzip();
        Ok(Self {
            plan: exact.map_or_else(|| cut(planned, near_s, to_s + COMMAND_TAIL_S), Ok)?,
            elsewhere,
            starts_s,
            duration_s: took_s(planned, [from_s, to_s]),
            span_s: [from_s, to_s],
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

    /// Says which key points of its task the plan misses, and whether a new one passes them.
    pub(super) fn remark_elsewhere(&self, anew: bool, remarks: &mut Remarks) {
        let next = if anew { "the next plan passes it" } else { "nor does the next, for the plan is kept" };
        for missed in &self.elsewhere {
            remarks.add(Code::OtherFile, 1, format!("{missed}; {next}"));
        }
    }

    /// The plan under the limits of a setup, if its times are known.
    pub(super) fn evaluation(&self, setup: &Setup) -> Result<Option<PlanEvaluation>, PlanError> {
        let of = |times_s: &Vec<f64>| PlanEvaluation::through(setup, times_s, &self.via);
        self.times_s.as_ref().map(of).transpose()
    }
}

/// When the motion between two instants begins and ends in earnest, s: a slow plan creeps away from its rest below the
/// speed that is called motion. Only where the rests around it are not reached otherwise.
fn rests_s(planned: &Series, [from_s, to_s]: [f64; 2]) -> [f64; 2] {
    let away = |at_s: f64, rest_s: f64| {
        let far =
            |track: &Track| (track.held_at(at_s).position - track.held_at(rest_s).position).abs() > AT_REST;
        planned.tracks.iter().any(far)
    };
    let walk = |from_s: f64, by_s: f64, margin_s: f64| {
        let rest_s = from_s + by_s.signum() * MOST_CREEP_S;
        let mut at_s = from_s;
        while away(at_s + by_s.signum() * margin_s, rest_s) && (at_s - from_s).abs() < MOST_CREEP_S {
            at_s += by_s;
        }
        at_s
    };
    [walk(from_s, -CREEP_STEP_S, PLAN_LEAD_S), walk(to_s, CREEP_STEP_S, COMMAND_TAIL_S)]
}

/// How long a plan takes that is called motion between two instants, s: it leaves its rest, and comes to it, below the speed of one.
fn took_s(planned: &Series, [from_s, to_s]: [f64; 2]) -> f64 {
    let creeps_s = |from_s: f64, rest_s: f64| {
        let by_s = CREPT_STEP_S.copysign(rest_s - from_s);
        let apart = |track: &Track, k: u32, at_s: f64| {
            (track.held_at(at_s + by_s * f64::from(k)).position - track.held_at(rest_s).position).abs()
        };
        // What a plan wavers by at rest is no motion.
        let wavers = |track: &Track| (0..WAVERS).map(|k| apart(track, k, rest_s)).fold(0.0, f64::max);
        let least: Vec<f64> = planned.tracks.iter().map(|track| CREPT + 4.0 * wavers(track)).collect();
        let away = |k: &u32| {
            planned.tracks.iter().zip(&least).any(|(track, least)| apart(track, *k, from_s) > *least)
        };
        let steps = (0_u32..).take_while(|k| (by_s * f64::from(*k)).abs() < (rest_s - from_s).abs());
        steps.take_while(away).last().map_or(0.0, |k| CREPT_STEP_S * f64::from(k))
    };
    to_s - from_s + creeps_s(from_s, from_s - PLAN_LEAD_S) + creeps_s(to_s, to_s + COMMAND_TAIL_S)
}

/// How far a plan passes a key point of its task, rad or m.
const PASSES_RAD: f64 = 0.5 * DEGREE_RAD;

/// A task that is given must begin where the plan does, or the arm would jump there. Other key points that the plan does
/// not pass are told of.
fn check_points(
    path: &Path,
    request: &PlanRequest,
    planned: &Series,
    [from_s, to_s]: [f64; 2],
) -> Result<Vec<String>, ReplanFailure> {
    let setup = &request.setup;
    let names = setup.joint_names();
    let tracks: Vec<&Track> = names.iter().filter_map(|name| planned.track(name)).collect();
    let points = setup.template().points();
    let kind = |joint: usize| setup.joint_kinds().nth(joint).unwrap_or_default();
    // The joint that is farthest from a point at an instant, and how far.
    let apart = |point: usize, t_s: f64| {
        let each =
            tracks.iter().zip(points.of(point)).map(|(track, q)| (track.held_at(t_s).position - q).abs());
        each.enumerate().fold((0, 0.0), |most, (joint, far)| if far > most.1 { (joint, far) } else { most })
    };
    let (joint, far) = apart(0, from_s - PLAN_LEAD_S);
    if far > PASSES_RAD {
        let (kind, joint) = (kind(joint), names.get(joint).cloned().unwrap_or_default());
        return Err(ReplanFailure::OtherStart { path: path.to_owned(), joint, kind, far });
    }
    let instants = || (0..=INSTANTS).map(|k| from_s + (to_s - from_s) * f64::from(k) / f64::from(INSTANTS));
    let nearest = |point: usize| {
        let all = instants().map(|t_s| apart(point, t_s));
        all.fold((0, f64::INFINITY), |best, now| if now.1 < best.1 { now } else { best })
    };
    let missed =
        (1..setup.template().t_s().len()).filter(|point| !setup.is_free(*point)).filter_map(|point| {
            let (joint, far) = nearest(point);
            (far > MISSES_RAD).then(|| {
                format!(
                    "the plan in {} does not pass key point {} of the task: {} stays {} away from it",
                    path.display(),
                    point + 1,
                    names.get(joint).map_or("", String::as_str),
                    kind(joint).says(far)
                )
            })
        });
    Ok(missed.collect())
}

/// A plan that is broken would be one with a start, a stop or a jump that no arm can make.
fn whole(path: &Path, what: &'static str, broken: Option<Broken>) -> Result<(), ReplanFailure> {
    let path = path.to_owned();
    broken.map_or(Ok(()), |broken| Err(ReplanFailure::Broken { path, what, broken }))
}

fn has_joints(request: &PlanRequest, planned: &Series) -> bool {
    request.setup.joint_names().iter().all(|name| planned.track(name).is_some())
}

/// The task's joints must be in the log, or its timing would be judged on joints that nobody measured; `own`: the task is the log's.
fn check_joints(
    path: &Path,
    request: &PlanRequest,
    planned: &Series,
    own: bool,
) -> Result<(), ReplanFailure> {
    if has_joints(request, planned) {
        return Ok(());
    }
    let log: Vec<&str> = planned.tracks.iter().map(Track::name).collect();
    let [task, log] = [request.setup.joint_names().join(", "), log.join(", ")];
    let path = path.to_owned();
    Err(if own {
        ReplanFailure::SomeJoints { path, task, log }
    } else {
        ReplanFailure::OtherArm { path, task, log }
    })
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
    fn a_plan_takes_as_long_as_it_is_off_its_rests() {
        // From 3 s to 23 s by 0.5 rad, at rest up to its jerk.
        let at = |t_s: f64| {
            let u = ((t_s - 3.0) / 20.0).clamp(0.0, 1.0);
            0.5 * u.powi(4) * (35.0 - 84.0 * u + 70.0 * u * u - 20.0 * u.powi(3))
        };
        let plan = Series::sampled("J", 2600, at);
        let called_s = moving_s(&plan).unwrap();
        assert!(called_s[1] - called_s[0] < 18.8, "{called_s:?}");
        let took_s = took_s(&plan, called_s);
        assert!((19.6..=20.0).contains(&took_s), "{took_s}");
    }

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
