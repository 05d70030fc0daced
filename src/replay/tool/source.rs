//! Where planned and measured poses of the tool come from: joints of an arm, or the log itself.

use std::ops::Range;

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use super::{
    deviation::{angle_rad, deviation},
    instants::Instants,
    outcome::ToolDeviation,
};
use crate::{
    arm::{Kinematics, Pose},
    replay::Rules,
    series::{PosePair, PoseSample},
};

/// Planned and measured poses of a tool at common instants.
pub(super) trait Source: Sync {
    fn t_s(&self) -> &[f64];

    /// Continuous stretches.
    fn segments(&self) -> &[Range<usize>];

    /// Planned and measured.
    fn poses(&self, i: usize) -> [Pose; 2];

    /// Whether the orientation is known.
    fn is_oriented(&self) -> bool {
        true
    }

    /// Whether the plan moves slower than rest allows between two instants.
    fn rests(&self, from_to: [usize; 2], rules: &Rules) -> bool;

    /// The mean over some instants.
    fn deviation(&self, some: Range<usize>) -> ToolDeviation;
}

/// The joints of an arm.
pub(super) struct Joints<'a> {
    pub(super) arm: &'a Kinematics,
    pub(super) instants: Instants,
}

impl Source for Joints<'_> {
    fn t_s(&self) -> &[f64] {
        &self.instants.t_s
    }

    fn segments(&self) -> &[Range<usize>] {
        &self.instants.segments
    }

    fn poses(&self, i: usize) -> [Pose; 2] {
        self.instants.at(i).map(|position| self.arm.tool_pose(position))
    }

    fn rests(&self, [low, high]: [usize; 2], rules: &Rules) -> bool {
        let time_s = self.instants.t_s[high] - self.instants.t_s[low];
        let ([from, _], [to, _]) = (self.instants.at(low), self.instants.at(high));
        let joints = self.arm.joints().zip(from.iter().zip(to));
        joints.into_iter().all(|((_, kind), (a, b))| (b - a).abs() <= rules.sizes(kind).stop_speed * time_s)
    }

    fn deviation(&self, some: Range<usize>) -> ToolDeviation {
        let [planned, measured] = self.instants.mean(some);
        deviation(self.arm, &planned, &measured)
    }
}

impl Source for PosePair {
    fn t_s(&self) -> &[f64] {
        &self.t_s
    }

    fn segments(&self) -> &[Range<usize>] {
        &self.segments
    }

    fn poses(&self, i: usize) -> [Pose; 2] {
        [&self.planned[i], &self.measured[i]].map(pose)
    }

    fn is_oriented(&self) -> bool {
        self.is_oriented()
    }

    fn rests(&self, [low, high]: [usize; 2], rules: &Rules) -> bool {
        let time_s = self.t_s[high] - self.t_s[low];
        let ends = [low, high].map(|i| pose(&self.planned[i]));
        let moved_m = (ends[1].translation.vector - ends[0].translation.vector).norm();
        moved_m <= rules.sliding.stop_speed * time_s && angle_rad(&ends) <= rules.turning.stop_speed * time_s
    }

    fn deviation(&self, some: Range<usize>) -> ToolDeviation {
        let sides = [&self.planned, &self.measured].map(|side| pose(&mean(&side[some.clone()])));
        ToolDeviation {
            error_m: (sides[0].translation.vector - sides[1].translation.vector).norm(),
            orientation_rad: self.is_oriented().then(|| angle_rad(&sides)),
            causes: Vec::new(),
            nonlinear_share: 0.0,
        }
    }
}

/// The mean of poses near to each other, whose quaternions are of one sign.
fn mean(some: &[PoseSample]) -> PoseSample {
    let count = some.len().max(1) as f64;
    std::array::from_fn(|k| some.iter().map(|pose| pose[k]).sum::<f64>() / count)
}

fn pose(&[x, y, z, qx, qy, qz, qw]: &PoseSample) -> Pose {
    let turn = UnitQuaternion::try_new(Quaternion::new(qw, qx, qy, qz), 0.0).unwrap_or_default();
    Pose::from_parts(Vector3::new(x, y, z).into(), turn.to_rotation_matrix())
}
