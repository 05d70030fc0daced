//! Whether a task holds what its documentation says, for one that was built in code.

use super::PlanError;
use crate::task::{Boundary, JointLimits, Place, Task};

/// # Errors
///
/// [`PlanError::Task`] for the first thing that does not hold.
pub(super) fn check(task: &Task) -> Result<(), PlanError> {
    let joints = task.joints.len();
    let that = |holds: bool, what: &'static str, expected: &str| {
        let bad = || PlanError::Task { what, expected: expected.to_owned() };
        holds.then_some(()).ok_or_else(bad)
    };
    let each = &format!("one for each of {joints} joints");
    that(task.kinds.len() == joints, "kinds of joints", each)?;
    that(task.limits.len() == joints, "limits of joints", each)?;
    that((5..=7).contains(&task.degree), "degree of the spline", "5, 6 or 7")?;
    that(task.points.len() >= 2, "key points", "two or more")?;
    for point in &task.points {
        match &point.place {
            Place::Joints(q) => {
                that(q.len() == joints, "positions of a key point", each)?;
                that(q.iter().all(|q| q.is_finite()), "positions of a key point", "finite numbers")?;
            }
            Place::Tool { x_m, z_m, pitch_rad, .. } => {
                let place = [x_m, z_m, pitch_rad];
                that(place.iter().all(|value| value.is_finite()), "place of the tool", "finite numbers")?;
            }
        }
        let dwell_s = point.dwell_s.unwrap_or(0.0);
        that(dwell_s.is_finite() && dwell_s >= 0.0, "dwell of a key point", "a time in seconds")?;
    }
    for Boundary { velocity_rad_s, acceleration_rad_s2, jerk_rad_s3 } in [&task.start, &task.end] {
        for values in [velocity_rad_s, acceleration_rad_s2, jerk_rad_s3] {
            let fits = values.len() == joints && values.iter().all(|value| value.is_finite());
            that(fits, "motion at an end", each)?;
        }
    }
    let [shortest, longest] = task.interval_s;
    let interval = longest.is_finite() && 0.0 < shortest && shortest <= longest;
    that(interval, "shortest and longest interval", "two times in seconds, the shorter first")?;
    for limits in &task.limits {
        let JointLimits {
            range_rad,
            velocity_rad_s,
            acceleration_rad_s2,
            jerk_rad_s3,
            torque_n_m,
            rod_speed_m_s,
        } = limits;
        let [slowest, fastest] = velocity_rad_s;
        let speeds = *slowest < 0.0 && *fastest > 0.0 && slowest.is_finite() == fastest.is_finite();
        that(
            speeds,
            "speeds of a joint",
            "the lowest below zero and the highest above it, both finite or neither",
        )?;
        let most = [acceleration_rad_s2, jerk_rad_s3, torque_n_m, rod_speed_m_s];
        that(most.iter().all(|limit| **limit > 0.0), "limits of a joint", "numbers above zero, or infinity")?;
        let range = range_rad.is_none_or(|[low, high]| low <= high);
        that(range, "range of a joint", "its lower end first")?;
    }
    that(task.tool_speed_m_s > 0.0, "speed of the tool", "a number above zero, or infinity")?;
    let size = task.payload_size_m.iter().all(|side| side.is_finite() && *side >= 0.0);
    that(size, "size of the payload", "three lengths in metres")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{arm::Arm, plan::Setup};

    #[test]
    fn a_task_that_was_built_wrongly_is_an_error_and_no_panic() {
        let text = include_str!("../../sample-logs/tasks/task-1.toml");
        let task = Task::parse(text).unwrap();
        assert_eq!(check(&task), Ok(()));
        let wrong: [fn(&mut Task); 11] = [
            |task| task.kinds.clear(),
            |task| task.limits.clear(),
            |task| task.degree = 3,
            |task| task.points.truncate(1),
            |task| task.points[1].place = Place::Joints(vec![0.0]),
            |task| task.points[1].place = Place::Joints(vec![f64::NAN; 6]),
            |task| task.points[1].dwell_s = Some(f64::INFINITY),
            |task| task.start.velocity_rad_s = vec![0.1],
            |task| task.interval_s = [2.0, 1.0],
            |task| task.limits[0].velocity_rad_s[1] = f64::NAN,
            |task| task.tool_speed_m_s = 0.0,
        ];
        for (k, change) in wrong.into_iter().enumerate() {
            let mut task = task.clone();
            change(&mut task);
            let found = Setup::new(&task, Arm::sample().unwrap()).map(|_| ());
            assert!(matches!(found, Err(PlanError::Task { .. })), "{k}: {found:?}");
        }
    }
}
