//! Where the links are and how fast the tool moves.

use nalgebra::{Matrix6xX, Rotation3, Translation3, Vector3};

use super::{Chain, Pose};

impl Chain {
    /// Pose of every link on the way to the tool, in the base's frame; the base itself comes first.
    ///
    /// Positions, rad or m, beyond the number of joints are ignored, missing ones are zero.
    pub fn link_poses(&self, position_rad: &[f64]) -> Vec<Pose> {
        let frames = self.frames(position_rad);
        self.links.iter().filter_map(|link| Some(frames.get(link.frame)? * link.place)).collect()
    }

    /// Pose of the tool in the base's frame; as [`Chain::link_poses`].
    pub fn tool_pose(&self, position_rad: &[f64]) -> Pose {
        self.frames(position_rad).last().map_or(self.tool, |last| last * self.tool)
    }

    /// How the tool follows the joints: for each joint a column of the tool's linear velocity, m/rad or m/m,
    /// above its angular velocity, both along the base's axes.
    pub fn tool_jacobian(&self, position_rad: &[f64]) -> Matrix6xX<f64> {
        let frames = self.frames(position_rad);
        let tool_m = frames.last().map_or(self.tool, |last| last * self.tool).translation.vector;
        let mut jacobian = Matrix6xX::zeros(self.joint_count());
        let steps = frames.iter().skip(1).zip(&self.steps);
        for (mut column, (frame, step)) in jacobian.column_iter_mut().zip(steps) {
            let axis = frame.rotation * Vector3::z();
            if step.slides {
                column.fixed_rows_mut::<3>(0).copy_from(&axis);
                continue;
            }
            column.fixed_rows_mut::<3>(0).copy_from(&axis.cross(&(tool_m - frame.translation.vector)));
            column.fixed_rows_mut::<3>(3).copy_from(&axis);
        }
        jacobian
    }

    /// Speed of the tool's origin, m/s. Allocates nothing.
    pub fn tool_speed_m_s(&self, position_rad: &[f64], speed_rad_s: &[f64]) -> f64 {
        let (mut turn, mut velocity) = (Vector3::zeros(), Vector3::zeros());
        for ((step, &q), &qd) in self.steps.iter().zip(position_rad).zip(speed_rad_s) {
            velocity += turn.cross(&step.offset_m);
            if step.slides {
                (velocity, turn) = (step.rotation.tr_mul(&velocity), step.rotation.tr_mul(&turn));
                velocity += turn.cross(&(Vector3::z() * q)) + Vector3::z() * qd;
                continue;
            }
            let back =
                (step.rotation * Rotation3::from_axis_angle(&Vector3::z_axis(), q).matrix()).transpose();
            velocity = back * velocity;
            turn = back * turn + Vector3::z() * qd;
        }
        (velocity + turn.cross(&self.tool.translation.vector)).norm()
    }

    /// Frames of base and joints in the base's frame, z along the axes.
    fn frames(&self, position_rad: &[f64]) -> Vec<Pose> {
        let mut frame = Pose::identity();
        let mut frames = Vec::with_capacity(self.steps.len() + 1);
        frames.push(frame);
        for (i, step) in self.steps.iter().enumerate() {
            let q = position_rad.get(i).copied().unwrap_or(0.0);
            let rotation = Rotation3::from_matrix_unchecked(step.rotation);
            frame *= if step.slides {
                let offset_m = step.offset_m + rotation * Vector3::new(0.0, 0.0, q);
                Pose::from_parts(Translation3::from(offset_m), rotation)
            } else {
                let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), q);
                Pose::from_parts(Translation3::from(step.offset_m), rotation * turn)
            };
            frames.push(frame);
        }
        frames
    }
}
