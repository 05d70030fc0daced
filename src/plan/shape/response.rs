//! How what the mechanics ask of the arm changes with the state of its joints, by difference quotients.

use crate::{
    plan::{Setup, mesh::Mesh},
    spline::Quantity,
};

/// Quantities of the state, by order of derivative.
pub(super) const STATE: [Quantity; 3] = [Quantity::Position, Quantity::Velocity, Quantity::Acceleration];

/// Step of the quotients, in rad and seconds: torques and rods are smooth at far larger scales.
const STEP: f64 = 1e-6;

/// Shares of limits and powers at the instants of a mesh, with their slopes.
pub(super) struct Response {
    instants: usize,
    joints: usize,
    /// `[row][instant]`: the mesh's rows of limits, then powers by joint, W.
    value: Vec<f64>,
    /// `[joint][order][row][instant]`.
    slope: Vec<f64>,
}

impl Response {
    /// At the state that the mesh looked at last; the mesh stays as it is.
    pub(super) fn of(setup: &Setup, mesh: &Mesh) -> Self {
        let (joints, instants) = (setup.joint_count(), mesh.t_s.len());
        let all = |mesh: &Mesh| mesh.shares.iter().chain(&mesh.power_w).copied().collect::<Vec<f64>>();
        let value = all(mesh);
        let mut slope = Vec::with_capacity(value.len() * joints * STATE.len());
        let mut beside = mesh.clone();
        for joint in 0..joints {
            for quantity in STATE {
                beside.samples.of_mut(quantity, joint).iter_mut().for_each(|value| *value += STEP);
                beside.load(setup);
                let there = beside.shares.iter().chain(&beside.power_w);
                slope.extend(there.zip(&value).map(|(there, here)| (there - here) / STEP));
                let as_before = mesh.samples.of(quantity, joint);
                beside.samples.of_mut(quantity, joint).copy_from_slice(as_before);
            }
        }
        Self { instants, joints, value, slope }
    }

    /// Rows of limits; powers follow.
    pub(super) fn limits(&self) -> usize {
        self.value.len() / self.instants.max(1) - self.joints
    }

    pub(super) fn value(&self, row: usize, instant: usize) -> f64 {
        self.value[row * self.instants + instant]
    }

    /// By the derivative of an order of a joint's angle.
    pub(super) fn slope(&self, row: usize, instant: usize, (joint, order): (usize, usize)) -> f64 {
        self.slope[(joint * STATE.len() + order) * self.value.len() + row * self.instants + instant]
    }
}
