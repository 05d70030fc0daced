//! How far the tool is off at one instant, and which joint's error makes how much of it.

use super::outcome::{ToolCause, ToolDeviation};
use crate::arm::{Kinematics, Pose};

/// Angle between two orientations, rad; exact for small ones, where the trace of a matrix is not.
pub(super) fn angle_rad([planned, measured]: &[Pose; 2]) -> f64 {
    let apart = planned.rotation.matrix() - measured.rotation.matrix();
    2.0 * (apart.norm() / 8.0_f64.sqrt()).min(1.0).asin()
}

/// Where the tool is for planned and measured positions of the joints.
///
/// The tool moves with a joint by that joint's column of the Jacobian, here at the measured pose, times the joint's
/// error; the part of that along the tool's own error is the joint's share.
pub(super) fn deviation(arm: &Kinematics, planned: &[f64], measured: &[f64]) -> ToolDeviation {
    let poses = [planned, measured].map(|position| arm.tool_pose(position));
    let error_m = poses[0].translation.vector - poses[1].translation.vector;
    let distance_m = error_m.norm();
    let mut found = ToolDeviation {
        error_m: distance_m,
        orientation_rad: Some(angle_rad(&poses)),
        causes: Vec::new(),
        nonlinear_share: 0.0,
    };
    let Some(along) = error_m.try_normalize(1e-12) else { return found };
    let moves = arm.tool_moves(measured);
    for (k, (joint, kind)) in arm.joints().enumerate() {
        let joint_error = planned[k] - measured[k];
        let error_m = joint_error * moves[k].dot(&along);
        let share = error_m / distance_m;
        found.causes.push(ToolCause { joint: joint.to_owned(), kind, joint_error, error_m, share });
    }
    found.nonlinear_share = 1.0 - found.causes.iter().map(|cause| cause.share).sum::<f64>();
    found
}
