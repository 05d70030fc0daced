//! Arms: what a URDF and a file of cylinders say, and the mechanics that follow.
//!
//! A [`Chain`] holds the geometry and the masses of any serial arm of joints that turn or slide: poses
//! ([`Chain::tool_pose`]), the tool's speed, inverse dynamics ([`Chain::inverse_dynamics`], in lanes
//! of several instants) and inverse kinematics ([`Chain::reach`]). [`Hydraulics`] holds the
//! cylinders, which turn joint motion and torque into rod speed, flow and force. [`Arm`] is both.
//! [`Rods`] turns lengths of cylinders into angles of joints and back. [`Kinematics`] holds the geometry alone, of joints that turn or slide.

mod chain;
mod cylinder;
mod description;
mod error;
mod hydraulics;
mod inertia;
mod inverse_dynamics;
mod kinematics;
mod linkage;
mod part;
mod reach;
mod robot;
mod rods;
mod serial;
mod shape;
mod urdf;

pub use chain::{Chain, Joint, JointLimit, Load};
pub use cylinder::{Actuation, Cylinder, Drive};
pub use description::{GHOST, GHOST_RGBA};
pub use error::ArmError;
pub use hydraulics::{Arm, Hydraulics};
pub use inertia::Inertia;
pub use inverse_dynamics::{LANES, Motion, Workspace, inverse_dynamics};
pub use linkage::Linkage;
pub use rods::{Rod, Rods, names_a_cylinder, names_a_slide, names_a_stroke};
pub use serial::Kinematics;
pub use shape::{Mesh, Shape, Solid, quaternion_xyzw};
pub use urdf::{continuous_joints, sliding_joints};

/// Place and orientation of a frame in another; lengths in m.
pub type Pose = nalgebra::IsometryMatrix3<f64>;

/// Standard gravity as used by every robot library, m/s².
pub const GRAVITY_M_S2: f64 = 9.81;
