//! The arm as a body: its inertia, its weight, the levers of its cylinders.

use super::{Plant, STEP_S};
use crate::arm::{Inertia, LANES, Motion, Workspace};

/// Steps between two looks at the arm's pose.
pub(super) const STEPS_A_POSE: usize = 10;

/// Inertia, weight and levers at one pose, joint by joint; nothing in it grows.
///
/// They change with the pose only, and within the millisecond between two looks by less than a thousandth.
#[derive(Debug, Clone)]
pub(super) struct Mechanics {
    work: Workspace<LANES>,
    position_rad: Vec<[f64; LANES]>,
    speed_rad_s: Vec<[f64; LANES]>,
    acceleration_rad_s2: Vec<[f64; LANES]>,
    torque_nm: Vec<[f64; LANES]>,
    /// Torque against weight and against the pull of the other joints' speeds, N m.
    pub(super) bias_nm: Vec<f64>,
    /// Inverse of the inertia matrix, row by row, 1/(kg m²).
    pub(super) mobility: Vec<f64>,
    /// Change of the cylinders' length by joint angle, m/rad.
    pub(super) lever_m: Vec<f64>,
    pub(super) out_m: Vec<f64>,
}

impl Mechanics {
    pub(super) fn new(plant: &Plant) -> Self {
        let n = plant.axes.len();
        let lanes = || vec![[0.0; LANES]; n];
        Self {
            work: Workspace::new(&plant.chain),
            position_rad: lanes(),
            speed_rad_s: lanes(),
            acceleration_rad_s2: lanes(),
            torque_nm: lanes(),
            bias_nm: vec![0.0; n],
            mobility: vec![0.0; n * n],
            lever_m: vec![0.0; n],
            out_m: vec![0.0; n],
        }
    }

    /// Looks at the arm in a pose and in motion, rad and rad/s, with a payload at the tool, kg.
    pub(super) fn look(&mut self, plant: &Plant, state: impl Iterator<Item = (f64, f64)>, payload_kg: f64) {
        let n = plant.axes.len();
        let rates = self.position_rad.iter_mut().zip(&mut self.speed_rad_s);
        for ((q, qd), (angle_rad, speed_rad_s)) in rates.zip(state) {
            (*q, *qd) = ([angle_rad; LANES], [speed_rad_s; LANES]);
        }
        let payload = Inertia::point(payload_kg, nalgebra::Vector3::zeros());
        let load = plant.chain.load(payload.as_ref());
        // Column 0 asks for no acceleration, column j for one of joint j.
        for pass in 0..=n / LANES {
            for (joint, lanes) in self.acceleration_rad_s2.iter_mut().enumerate() {
                for (lane, value) in lanes.iter_mut().enumerate() {
                    *value = f64::from(u8::from(pass * LANES + lane == joint + 1));
                }
            }
            let (position_rad, speed_rad_s) = (&*self.position_rad, &*self.speed_rad_s);
            let motion = Motion { position_rad, speed_rad_s, acceleration_rad_s2: &self.acceleration_rad_s2 };
            plant.chain.inverse_dynamics(&load, motion, &mut self.work, &mut self.torque_nm);
            for (row, (torque, bias)) in self.torque_nm.iter().zip(&mut self.bias_nm).enumerate() {
                for (lane, torque) in torque.iter().enumerate() {
                    let column = pass * LANES + lane;
                    if column == 0 {
                        *bias = *torque;
                    } else if column <= n {
                        self.mobility[row * n + column - 1] = torque - *bias;
                    }
                }
            }
        }
        invert(&mut self.mobility, n);
        let levers = self.lever_m.iter_mut().zip(&mut self.out_m);
        for ((lever, out), ((sin, cos), axis)) in levers.zip(self.work.sin_cos().zip(&plant.axes)) {
            let (length_m, lever_m) = axis.cylinder.length_and_lever(sin[0], cos[0]);
            (*lever, *out) = (lever_m, length_m - axis.shortest_m);
        }
    }
}

/// Inverts a symmetric positive definite matrix in its place, by sweeping out its rows.
fn invert(matrix: &mut [f64], n: usize) {
    for k in 0..n {
        let pivot = matrix[k * n + k];
        matrix[k * n + k] = 1.0;
        matrix[k * n..(k + 1) * n].iter_mut().for_each(|value| *value /= pivot);
        for i in (0..n).filter(|&i| i != k) {
            let factor = std::mem::take(&mut matrix[i * n + k]);
            for j in 0..n {
                matrix[i * n + j] -= factor * matrix[k * n + j];
            }
        }
    }
}

/// Rate of the stiffest swing that the step resolves, 1/s.
pub(super) const FASTEST_1_S: f64 = 0.7 / STEP_S;
