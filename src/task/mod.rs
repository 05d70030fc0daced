//! What the arm is to do: key points, dwells, payload, limits, and how to weigh the objectives.
//!
//! A task file is TOML with angles in degrees, as the paper's tables have them, and positions of joints that slide in
//! millimetres; this folder is the edge where they become radians and metres. A task knows the names of joints and nothing of
//! links. Of a joint that slides read m for rad and N for N m.

mod by_objective;
mod document;
mod error;
mod file;
mod joints;
mod objective;

pub use by_objective::{ByObjective, Ceilings, Objectives, Weights};
pub use error::TaskError;
pub use objective::Objective;

use crate::series::JointKind;

/// Where the arm's description is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ArmSource {
    /// The sample arm that comes with hydrotrace.
    Sample,
    /// Files, relative to the task file.
    File {
        /// The URDF.
        urdf: String,
        /// Its cylinders and pump, if it has any.
        hydraulics: Option<String>,
        /// The link that is the tool, where the URDF leaves it open.
        tool: Option<String>,
    },
}

/// A pose of the arm that the plan passes through.
#[derive(Debug, Clone, PartialEq)]
pub struct KeyPoint {
    /// What people call it; may be empty.
    pub name: String,
    /// Where it is.
    pub place: Place,
    /// How long the arm rests here, s; `None` if it passes through.
    pub dwell_s: Option<f64>,
    /// Payload carried from the end of the dwell on, kg; `None` if it stays as it was.
    pub payload_kg: Option<f64>,
}

/// Where a key point is.
#[derive(Debug, Clone, PartialEq)]
pub enum Place {
    /// Joint positions, rad or m, in the order of [`Task::joints`].
    Joints(Vec<f64>),
    /// Position and pitch of the tool in the arm's plane, to be solved for the joints.
    Tool {
        /// Forward, m.
        x_m: f64,
        /// Up, m.
        z_m: f64,
        /// Pitch, rad; positive turns forward to down, as the joints do.
        pitch_rad: f64,
        /// Whether a free shape leaves the angles of the joints as they are solved first.
        fixed_angles: bool,
    },
}

/// Speed, acceleration and jerk at one end of the plan, `[joint]`; zero unless given.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Boundary {
    /// Speed, rad/s.
    pub velocity_rad_s: Vec<f64>,
    /// Acceleration, rad/s².
    pub acceleration_rad_s2: Vec<f64>,
    /// Jerk, rad/s³.
    pub jerk_rad_s3: Vec<f64>,
}

/// Limits of one joint; infinite where none is given.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointLimits {
    /// Lowest and highest angle, rad; `None` leaves the arm's own.
    pub range_rad: Option<[f64; 2]>,
    /// Lowest speed, below zero, and highest, rad/s: a cylinder goes out slower than it comes in. Both are finite, or neither.
    pub velocity_rad_s: [f64; 2],
    /// Acceleration, rad/s².
    pub acceleration_rad_s2: f64,
    /// Jerk, rad/s³.
    pub jerk_rad_s3: f64,
    /// Torque, N m; the cylinders' own limits hold besides.
    pub torque_n_m: f64,
    /// Speed of the cylinder's rod, m/s.
    pub rod_speed_m_s: f64,
}

/// A task, checked: arrays are as long as the joints, times increase, everything is finite.
#[derive(Debug, Clone, PartialEq)]
pub struct Task {
    /// What people call it.
    pub title: String,
    /// The arm.
    pub arm: ArmSource,
    /// Joint names; the order of every array.
    pub joints: Vec<String>,
    /// How they move, by the units that the file gives them; `None` of those that it says nothing of.
    pub kinds: Vec<Option<JointKind>>,
    /// Degree of the spline: 5, 6 or 7.
    pub degree: u8,
    /// At least two key points.
    pub points: Vec<KeyPoint>,
    /// Payload before the first change, kg.
    pub payload_kg: f64,
    /// Size of any payload, a box that reaches from the tool's origin forward along its x axis, m; zeros for a point.
    pub payload_size_m: [f64; 3],
    /// State in which the plan starts.
    pub start: Boundary,
    /// State in which the plan ends.
    pub end: Boundary,
    /// Shortest and longest time from one key point to the next, s; dwells excluded.
    pub interval_s: [f64; 2],
    /// Limits, `[joint]`.
    pub limits: Vec<JointLimits>,
    /// Speed of the tool, m/s; infinite where none is given.
    pub tool_speed_m_s: f64,
    /// Ceilings on the objectives.
    pub ceilings: Ceilings,
    /// How the objectives weigh against each other once the ceilings hold.
    pub weights: Option<Weights>,
    /// A time for each key point, s, if the plan is not to be optimised but evaluated.
    pub times_s: Option<Vec<f64>>,
}

impl Task {
    /// Number of joints.
    pub fn joint_count(&self) -> usize {
        self.joints.len()
    }

    /// Total time of the dwells, s.
    pub fn dwell_s(&self) -> f64 {
        self.points.iter().filter_map(|point| point.dwell_s).sum()
    }
}

#[cfg(test)]
mod tests;
