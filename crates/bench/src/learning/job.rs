//! What the machines of the study do: the paper's tasks at several timings, with payload.

use hydrotrace::{
    arm::Arm,
    plan::Setup,
    plant::PayloadChange,
    series::{Series, Track},
    spline::{Motion, Quantity, Samples},
    task::Task,
};

use super::LearningError;

/// Step of plans and commands, s.
const STEP_S: f64 = 0.01;

/// Rest before a motion, s.
const LEAD_S: f64 = 1.5;

/// Rest after it in a plan, s.
const TAIL_S: f64 = 3.0;

/// Task texts by number.
const TASKS: [&str; 2] = [
    include_str!("../../../../sample-logs/tasks/task-1.toml"),
    include_str!("../../../../sample-logs/tasks/task-2.toml"),
];

/// Name, task and arrivals at its key points, s: the paper's timings first.
const TIMINGS: [(&str, usize, &[f64]); 5] = [
    ("task 1, 38.7 s", 0, &[0.0, 7.744, 15.307, 22.863, 30.976, 38.72]),
    ("task 1, uneven", 0, &[0.0, 5.31, 11.47, 16.36, 26.27, 38.72]),
    ("task 1, 30.0 s", 0, &[0.0, 6.0, 11.86, 17.71, 24.0, 30.0]),
    ("task 2, 49.0 s", 1, &[0.0, 9.431, 19.334, 34.66, 39.14, 49.043]),
    ("task 2, 60.0 s", 1, &[0.0, 12.0, 24.0, 40.0, 47.0, 60.0]),
];

/// A plan to repeat.
#[derive(Debug, Clone)]
pub struct Job {
    /// What people call it.
    pub title: &'static str,
    /// The task on its arm.
    pub setup: Setup,
    /// The motion, which starts 1.5 s after the first sample of the plan.
    pub motion: Motion,
    /// Its samples, with rests.
    pub plan: Series,
    /// Payload by time.
    pub payload: Vec<PayloadChange>,
}

impl Job {
    /// All of them.
    ///
    /// # Errors
    ///
    /// [`LearningError`] if a task cannot be planned, which the tests exclude.
    pub fn all() -> Result<Vec<Self>, LearningError> {
        TIMINGS.iter().map(|(title, task, times_s)| Self::of(title, TASKS[*task], times_s)).collect()
    }

    fn of(title: &'static str, task: &str, times_s: &[f64]) -> Result<Self, LearningError> {
        let setup = Setup::new(&Task::parse(task)?, Arm::sample()?)?;
        let motion = setup.motion(times_s)?;
        let plan = sampled(&setup, &motion)?;
        let change = |(segment, &mass_kg): (&hydrotrace::spline::Segment, &f64)| PayloadChange {
            at_s: LEAD_S + segment.start_s,
            mass_kg,
        };
        let payload = motion.segments().iter().zip(setup.payload_kg()).map(change).collect();
        Ok(Self { title, setup, motion, plan, payload })
    }
}

fn sampled(setup: &Setup, motion: &Motion) -> Result<Series, LearningError> {
    let duration_s = motion.duration_s();
    let end_s = LEAD_S + duration_s + TAIL_S;
    let mut t_s = vec![0.0];
    while let Some(last) = t_s.last().filter(|last| **last < end_s) {
        t_s.push(last + STEP_S);
    }
    let local_s: Vec<f64> = t_s.iter().map(|t| t - LEAD_S).collect();
    let mut samples = Samples::default();
    motion.sample(&local_s, Quantity::Velocity, &mut samples);
    let inside = |(v, t): (&f64, &f64)| if (0.0..=duration_s).contains(t) { *v } else { 0.0 };
    let one = |(j, name): (usize, String)| {
        let speed = samples.of(Quantity::Velocity, j).iter().zip(&local_s).map(inside).collect();
        Track::new(name, t_s.clone(), samples.of(Quantity::Position, j).to_vec(), &[])?.with_velocity(speed)
    };
    Ok(Series { tracks: setup.joint_names().into_iter().enumerate().map(one).collect::<Result<_, _>>()? })
}
