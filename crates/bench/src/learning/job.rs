//! What the machines of the study do: the paper's tasks at several timings, with payload.

use std::path::Path;

use hydrotrace::{
    plan::PlanEvaluation,
    workflow::{
        carried::{
            Carried,
            plan_log::{PlanLog, Planned},
        },
        plan::{PlanDocument, PlanRequest},
    },
};

use super::LearningError;

/// Step of plans and commands, s.
const STEP_S: f64 = 0.01;

/// Task texts by number.
const TASKS: [&str; 2] = [
    include_str!("../../../../sample-logs/tasks/task-1.toml"),
    include_str!("../../../../sample-logs/tasks/task-2.toml"),
];

/// Name, task, its dwell, s, and arrivals at its key points, s: the paper's timings first.
const TIMINGS: [(&str, usize, f64, &[f64]); 6] = [
    ("task 1, 38.7 s", 0, DWELL_S, &[0.0, 7.744, 15.307, 22.863, 30.976, 38.72]),
    ("task 1, uneven", 0, DWELL_S, &[0.0, 5.31, 11.47, 16.36, 26.27, 38.72]),
    ("task 1, 30.0 s", 0, DWELL_S, &[0.0, 6.0, 11.86, 17.71, 24.0, 30.0]),
    ("task 2, 49.0 s", 1, DWELL_S, &[0.0, 9.431, 19.334, 34.66, 39.14, 49.043]),
    ("task 2, 60.0 s", 1, DWELL_S, &[0.0, 12.0, 24.0, 40.0, 47.0, 60.0]),
    ("task 1, waits", 0, 20.0, &[0.0, 7.744, 15.307, 22.863, 48.976, 56.72]),
];

/// Dwell of the tasks' texts, s.
const DWELL_S: f64 = 2.0;

/// A plan to repeat.
#[derive(Debug)]
pub struct Job {
    /// What people call it.
    pub title: &'static str,
    /// The log of the plan, with task and arm.
    pub log: Vec<u8>,
}

impl Job {
    /// All of them.
    ///
    /// # Errors
    ///
    /// [`LearningError`] if a task cannot be planned, which the tests exclude.
    pub fn all() -> Result<Vec<Self>, LearningError> {
        let dwell = |seconds: f64| format!("dwell_s = {seconds:.1}");
        TIMINGS
            .iter()
            .map(|(title, task, dwell_s, times_s)| {
                Self::of(title, TASKS[*task].replace(&dwell(DWELL_S), &dwell(*dwell_s)), times_s)
            })
            .collect()
    }

    fn of(title: &'static str, task: String, times_s: &[f64]) -> Result<Self, LearningError> {
        let request = PlanRequest::parse(Path::new("task.toml"), task)?;
        let evaluation = PlanEvaluation::of(&request.setup, times_s)?;
        let joints = request.setup.joint_names();
        let document = PlanDocument::evaluated(title, &joints, &evaluation, true);
        let motion = request.setup.motion(times_s)?;
        let carried = Carried::default().with_plan(&request.files, &document);
        let log = PlanLog {
            plan: Planned::Motion(&motion, &joints),
            command: None,
            arm: Some(&request.setup.arm().chain),
            trajectory: None,
            carried: &carried,
            rate_hz: 1.0 / STEP_S,
            points_hz: request.setup.points_hz(&motion),
        };
        Ok(Self { title, log: log.bytes()? })
    }
}
