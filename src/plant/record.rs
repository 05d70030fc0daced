//! What a run leaves behind.

use serde::Serialize;

/// A run as a log would hold it, and what no log holds.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Record {
    /// When the samples were taken, s since the start; jitter and losses included. Increasing.
    pub t_s: Vec<f64>,
    /// Pressure before the valves, Pa.
    pub supply_pa: Vec<f64>,
    /// Payload at the tool, kg.
    pub payload_kg: Vec<f64>,
    /// One entry a joint, in the order of the arm.
    pub joints: Vec<JointRecord>,
}

/// Columns of one joint, as long as [`Record::t_s`].
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct JointRecord {
    /// The joint.
    pub name: String,
    /// Angle that the encoder gives, rad.
    pub measured_rad: Vec<f64>,
    /// Speed that the driver makes of it, rad/s.
    pub measured_rad_s: Vec<f64>,
    /// Angle at the encoder without noise and counts, rad.
    pub true_rad: Vec<f64>,
    /// Its speed, rad/s.
    pub true_rad_s: Vec<f64>,
    /// Pressure on the side without a rod, Pa.
    pub cap_pressure_pa: Vec<f64>,
    /// Pressure on the side of the rod, Pa.
    pub rod_pressure_pa: Vec<f64>,
    /// Signal that the loop sends to the valve, within ±1, positive for growing angles.
    pub valve_command: Vec<f64>,
    /// Travel of the spool, share of the full one, with the same sense.
    pub spool: Vec<f64>,
}

impl Record {
    pub(super) fn with_room<'a>(joints: impl Iterator<Item = &'a str>, samples: usize) -> Self {
        let room = || Vec::with_capacity(samples);
        let joint = |name: &str| JointRecord {
            name: name.to_owned(),
            measured_rad: room(),
            measured_rad_s: room(),
            true_rad: room(),
            true_rad_s: room(),
            cap_pressure_pa: room(),
            rod_pressure_pa: room(),
            valve_command: room(),
            spool: room(),
        };
        Self { joints: joints.map(joint).collect(), t_s: room(), supply_pa: room(), payload_kg: room() }
    }
}
