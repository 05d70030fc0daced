//! A hydraulic arm that does not exist: valves, cylinders, oil, friction, loop and sensors of every
//! joint, the pump they share, and the body they move.
//!
//! [`simulate`] sends a command to a [`Plant`] and returns what a log of the machine would hold, with what no log
//! holds: the angle without noise. [`Plant::truth`] says what a fit to that log should find. Three presets differ in
//! what limits them, eleven have structures that these lack (loops, valves, links, days); all their numbers are in
//! `sample-logs/plant`. They are engineering guesses: no log of the arm of the paper was at hand.
//!
//! By joint: the position loop's signal waits a dead time, moves a spool through play, lag and slew rate; past its
//! overlap the spool opens two edges; oil flows by the root of the pressure drop, fills the cylinder's sides and is
//! compressed; their force, less friction, turns the joint. All joints draw on one pump, whose pressure droops, and all
//! move one body with its full inertia matrix, weight, centrifugal and Coriolis torques. What the loop and the log see
//! of the angle lies behind backlash, noise and quantisation.
//!
//! Links bend joint by joint, without pushing back on the arm. Hoses are volumes of oil.
//!
//! Not modelled: oil temperature and ageing, relief valves, pressure waves in lines, cavitation (pressures stop at zero), leakage of the valves,
//! dynamics of the pump, friction that depends on pressure, play of the joint under changing loads
//! (the backlash lies before the sensor only), swinging payloads, anti-windup of the loop. The
//! payload is a point at the tool.
//!
//! The state goes on by [`STEP_S`]: speeds first, then angles and pressures with the new speeds; pressures and bristles
//! linearly implicit. Inertia, weight and levers are looked up every millisecond.

mod controller;
mod cylinder;
mod encoder;
mod error;
mod file;
mod friction;
mod link;
mod machine;
mod mechanics;
mod parameters;
mod payload;
mod preset;
mod quantity;
mod random;
mod record;
mod set_value;
mod simulate;
mod truth;
mod valve;
mod variation;

pub use error::PlantError;
pub use parameters::{
    Chambers, Control, Cycle, Encoder, Friction, JointParameters, Link, Parameters, Supply, Valve,
};
pub use payload::PayloadChange;
pub use record::{JointRecord, Record};
pub use simulate::simulate;
pub use truth::{JointTruth, Truth};

use crate::{
    arm::{Arm, Chain, Cylinder, Drive, Joint},
    series::JointKind,
};
use cylinder::Size;

/// Step of the simulation, s.
pub const STEP_S: f64 = 1e-4;

/// An arm with everything that drives it, checked: all joints have cylinders and parameters in range.
#[derive(Debug, Clone)]
pub struct Plant {
    chain: Chain,
    parameters: Parameters,
    /// By joint.
    axes: Vec<Axis>,
}

/// The cylinders of one joint.
#[derive(Debug, Clone, Copy)]
struct Axis {
    cylinder: Cylinder,
    size: Size,
    /// Length with the rods fully in, m.
    shortest_m: f64,
    /// 1 where extending raises the joint's angle, -1 where it lowers it.
    sense: f64,
}

impl Plant {
    /// Puts a machine around an arm.
    ///
    /// # Errors
    ///
    /// [`PlantError`]: other joints than the arm's, joints without cylinders, numbers out of range.
    pub fn new(arm: &Arm, parameters: Parameters) -> Result<Self, PlantError> {
        quantity::check(&parameters).map_err(|flaw| flaw.at(None))?;
        let joints = arm.chain.joints();
        if let Some(joint) = joints.iter().find(|joint| joint.kind == JointKind::Slides) {
            return Err(PlantError::Slides { joint: joint.name.clone() });
        }
        if !joints.iter().map(|joint| &joint.name).eq(parameters.joints.iter().map(|joint| &joint.name)) {
            let plant: Vec<&str> = parameters.joints.iter().map(|joint| joint.name.as_str()).collect();
            let arm: Vec<&str> = joints.iter().map(|joint| joint.name.as_str()).collect();
            return Err(PlantError::OtherArm { plant: plant.join(", "), arm: arm.join(", ") });
        }
        let axis = |(joint, cylinder): (&Joint, &Option<Cylinder>)| {
            let cylinder = cylinder.ok_or_else(|| PlantError::NoCylinder { joint: joint.name.clone() })?;
            let Drive::Turns(linkage) = *cylinder.drive() else {
                return Err(PlantError::Slides { joint: joint.name.clone() });
            };
            let ends_m = [joint.limit.lower_rad, joint.limit.upper_rad].map(|q| {
                let (sin, cos) = q.sin_cos();
                cylinder.length_and_lever(sin, cos).0
            });
            let shortest_m = ends_m[0].min(ends_m[1]);
            let (cap_area_m2, rod_area_m2) = (cylinder.push_area_m2(), cylinder.pull_area_m2());
            let size = Size { cap_area_m2, rod_area_m2, stroke_m: ends_m[0].max(ends_m[1]) - shortest_m };
            Ok(Axis { cylinder, size, shortest_m, sense: linkage.sense })
        };
        let axes = joints.iter().zip(arm.hydraulics.cylinders()).map(axis);
        let axes = axes.collect::<Result<Vec<_>, PlantError>>()?;
        Ok(Self { chain: arm.chain.clone(), parameters, axes })
    }

    /// Its numbers.
    pub fn parameters(&self) -> &Parameters {
        &self.parameters
    }

    /// Names of the joints, in the order of the arm.
    pub fn joints(&self) -> impl Iterator<Item = &str> {
        self.parameters.joints.iter().map(|joint| joint.name.as_str())
    }
}

#[cfg(test)]
mod tests;
