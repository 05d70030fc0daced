//! Angles of the joints at the key points of a task.

use nalgebra::{Rotation3, Translation3, Vector3};

use super::PlanError;
use crate::{
    arm::{Arm, ArmError, Pose},
    spline::KeyPoints,
    task::{KeyPoint, Place, Task},
};

/// Slack of a key point at the end of a joint's range, rad; files round angles.
const SLACK_RAD: f64 = 1e-6;

/// Shares of a range that a posture keeps clear of each end, as far as it can.
const CLEAR: [f64; 3] = [0.1, 0.03, 0.0];

/// Key points in the arm's order; those given by the tool are solved near the one before.
pub(super) fn key_points(
    task: &Task,
    arm: &Arm,
    order: &[usize],
    range_rad: &[[f64; 2]],
) -> Result<KeyPoints, PlanError> {
    let middle = |[low, high]: &[f64; 2]| {
        if low.is_finite() && high.is_finite() { 0.5 * (low + high) } else { 0.0 }
    };
    let mut near: Vec<f64> = range_rad.iter().map(middle).collect();
    let mut position_rad = Vec::with_capacity(task.points.len() * order.len());
    for (point, key) in task.points.iter().enumerate() {
        near = match &key.place {
            Place::Joints(angles) => order.iter().map(|&own| angles[own]).collect(),
            Place::Tool { x_m, z_m, pitch_rad, .. } => {
                reached(arm, range_rad, &tool_pose([*x_m, *z_m], *pitch_rad), &near)
                    .map_err(|source| PlanError::Unreachable { point: point + 1, source })?
            }
        };
        for (j, (angle_rad, &[lowest_rad, highest_rad])) in near.iter_mut().zip(range_rad).enumerate() {
            let found_rad = *angle_rad;
            if found_rad < lowest_rad - SLACK_RAD || found_rad > highest_rad + SLACK_RAD {
                let (joint, kind) = (arm.chain.joints()[j].name.clone(), arm.chain.joints()[j].kind);
                return Err(PlanError::PointOutside {
                    point: point + 1,
                    joint,
                    kind,
                    found_rad,
                    lowest_rad,
                    highest_rad,
                });
            }
            // Beyond the end by no more than the slack, no plan keeps the range.
            *angle_rad = found_rad.max(lowest_rad).min(highest_rad);
        }
        position_rad.extend_from_slice(&near);
    }
    Ok(KeyPoints::new(order.len(), position_rad)?)
}

/// A posture near another, clear of the ends of the ranges if there is one: a spline that passes an end leaves the range.
fn reached(arm: &Arm, range_rad: &[[f64; 2]], pose: &Pose, near: &[f64]) -> Result<Vec<f64>, ArmError> {
    let clear = |share: f64| {
        let range = move |&[low, high]: &[f64; 2]| {
            let room = if low.is_finite() && high.is_finite() { share * (high - low) } else { 0.0 };
            [low + room, high - room]
        };
        arm.chain.clone().within(range_rad.iter().map(range)).reach(pose, near)
    };
    CLEAR.into_iter().map(clear).find(Result::is_ok).unwrap_or_else(|| arm.chain.reach(pose, near))
}

fn tool_pose([x_m, z_m]: [f64; 2], pitch_rad: f64) -> Pose {
    let turn = Rotation3::from_axis_angle(&Vector3::y_axis(), pitch_rad);
    Pose::from_parts(Translation3::new(x_m, 0.0, z_m), turn)
}

/// Of key points where the arm passes and the task gives the tool alone.
pub(super) fn poses(task: &Task, rests: &[usize]) -> Vec<Option<Pose>> {
    let last = task.points.len() - 1;
    let of = |(point, key): (usize, &KeyPoint)| match key.place {
        Place::Tool { x_m, z_m, pitch_rad, fixed_angles: false }
            if point > 0 && point < last && !rests.contains(&point) =>
        {
            Some(tool_pose([x_m, z_m], pitch_rad))
        }
        _ => None,
    };
    task.points.iter().enumerate().map(of).collect()
}
