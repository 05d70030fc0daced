//! The messages of a log, as samples of all joints, and their layout in CDR.

use super::{
    WriteError,
    cdr::Cdr,
    stamp::{Stamp, encode_duration},
};

/// The state of all joints at one instant: one value a joint in the order of the log's joint
/// names, or an empty slice where nothing is known. NaN stands for a single unknown value.
#[derive(Debug, Clone, Copy, Default)]
pub struct Point<'a> {
    /// Angles, rad.
    pub position_rad: &'a [f64],
    /// Velocities, rad/s.
    pub velocity_rad_s: &'a [f64],
    /// Accelerations, rad/s².
    pub acceleration_rad_s2: &'a [f64],
    /// Torques, N m.
    pub effort_n_m: &'a [f64],
    /// Time since the trajectory started, ns.
    pub time_from_start_ns: i64,
}

/// The state of a trajectory controller at one instant. Its error is reference minus feedback and
/// is computed on writing, for every quantity that both give.
#[derive(Debug, Clone, Copy)]
pub struct ControllerState<'a> {
    /// Where the plan wants the joints.
    pub reference: Point<'a>,
    /// Where they are.
    pub feedback: Point<'a>,
    /// The controller's command.
    pub output: Point<'a>,
    /// Speed at which the trajectory runs, of that planned; 0 is a pause.
    pub speed_scaling_factor: f64,
}

impl Point<'_> {
    pub(super) fn check(&self, joints: usize) -> Result<(), WriteError> {
        let Self { position_rad, velocity_rad_s, acceleration_rad_s2, effort_n_m, .. } = self;
        check_length("position", position_rad, joints)?;
        check_length("velocity", velocity_rad_s, joints)?;
        check_length("acceleration", acceleration_rad_s2, joints)?;
        check_length("effort", effort_n_m, joints)
    }

    /// `trajectory_msgs/JointTrajectoryPoint`
    fn encode(&self, cdr: &mut Cdr) -> Result<(), WriteError> {
        for values in [self.position_rad, self.velocity_rad_s, self.acceleration_rad_s2, self.effort_n_m] {
            cdr.f64_sequence(values.iter().copied());
        }
        encode_duration(cdr, self.time_from_start_ns)
    }

    /// `trajectory_msgs/JointTrajectoryPoint` of the difference to another point.
    fn encode_minus(&self, other: &Self, cdr: &mut Cdr) -> Result<(), WriteError> {
        for (ours, theirs) in [
            (self.position_rad, other.position_rad),
            (self.velocity_rad_s, other.velocity_rad_s),
            (self.acceleration_rad_s2, other.acceleration_rad_s2),
            (self.effort_n_m, other.effort_n_m),
        ] {
            cdr.f64_sequence(ours.iter().zip(theirs).map(|(a, b)| a - b));
        }
        encode_duration(cdr, self.time_from_start_ns)
    }
}

/// A quantity is given for all joints or not at all.
pub(super) fn check_length(quantity: &'static str, values: &[f64], joints: usize) -> Result<(), WriteError> {
    if values.is_empty() || values.len() == joints {
        return Ok(());
    }
    Err(WriteError::LengthMismatch { quantity, joints, values: values.len() })
}

/// The start of every message: `std_msgs/Header` without a frame, then the joint names.
pub(super) fn encode_header(cdr: &mut Cdr, stamp: Stamp, joint_names: &[String]) {
    cdr.begin();
    stamp.encode(cdr);
    cdr.string("");
    cdr.strings(joint_names);
}

/// `sensor_msgs/JointState` behind its header.
pub(super) fn encode_joint_state(cdr: &mut Cdr, quantities: [&[f64]; 3]) {
    for values in quantities {
        cdr.f64_sequence(values.iter().copied());
    }
}

/// `control_msgs/DynamicJointState` behind its header; every interface has a value a joint.
pub(super) fn encode_interfaces(cdr: &mut Cdr, joints: usize, interfaces: &[(&str, &[f64])]) {
    cdr.count(joints);
    for joint in 0..joints {
        cdr.count(interfaces.len());
        for (name, _) in interfaces {
            cdr.string(name);
        }
        cdr.count(interfaces.len());
        for (_, values) in interfaces {
            cdr.f64(values.get(joint).copied().unwrap_or(f64::NAN));
        }
    }
}

/// `trajectory_msgs/JointTrajectory` behind its header.
pub(super) fn encode_trajectory(cdr: &mut Cdr, points: &[Point]) -> Result<(), WriteError> {
    cdr.count(points.len());
    points.iter().try_for_each(|point| point.encode(cdr))
}

/// `control_msgs/JointTrajectoryControllerState` behind its header; no joint has several degrees
/// of freedom.
pub(super) fn encode_controller_state(cdr: &mut Cdr, state: &ControllerState) -> Result<(), WriteError> {
    state.reference.encode(cdr)?;
    state.feedback.encode(cdr)?;
    state.reference.encode_minus(&state.feedback, cdr)?;
    state.output.encode(cdr)?;
    cdr.count(0);
    for _ in ["reference", "feedback", "error", "output"] {
        for _ in ["transforms", "velocities", "accelerations"] {
            cdr.count(0);
        }
        encode_duration(cdr, 0)?;
    }
    cdr.f64(state.speed_scaling_factor);
    Ok(())
}
