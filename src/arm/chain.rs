//! A serial chain of joints that turn or slide, in the form that its mechanics need.

use std::sync::Arc;

use nalgebra::{Matrix3, Rotation3, Translation3, Unit, Vector3};

use super::{Inertia, Pose, robot::Robot};
use crate::series::JointKind;

/// What a joint may do; of one that slides read m for rad and N for N m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointLimit {
    /// Smallest angle, rad; minus infinity for a continuous joint.
    pub lower_rad: f64,
    /// Largest angle, rad; infinity for a continuous joint.
    pub upper_rad: f64,
    /// Largest torque either way, N m; infinity where the file gives none.
    pub torque_nm: f64,
    /// Largest speed either way, rad/s; infinity where the file gives none.
    pub speed_rad_s: f64,
}

/// One joint.
#[derive(Debug, Clone, PartialEq)]
pub struct Joint {
    /// Name, distinct within the chain.
    pub name: String,
    /// Whether it turns or slides.
    pub kind: JointKind,
    /// What it may do.
    pub limit: JointLimit,
    /// Damping and friction by its file, N m s/rad and N m (N s/m and N if it slides): in no torque of this arm.
    pub resists: [f64; 2],
}

/// From one joint to the next: the next frame at position zero, seen from this one.
///
/// Every joint frame has its z axis along the joint's axis, whatever the file's axis is.
#[derive(Debug, Clone, Copy)]
pub(super) struct Step {
    pub(super) rotation: Matrix3<f64>,
    pub(super) offset_m: Vector3<f64>,
    /// Whether the joint slides along its axis instead of turning about it.
    pub(super) slides: bool,
}

/// A link of the file and where it rides.
#[derive(Debug, Clone)]
pub(super) struct Link {
    pub(super) name: String,
    /// The joint it moves with, counted from one; zero is the base.
    pub(super) frame: usize,
    /// Its frame, seen from that joint's frame.
    pub(super) place: Pose,
}

/// A serial chain with at least one joint. All numbers in it are finite but for limits.
#[derive(Debug, Clone)]
pub struct Chain {
    pub(super) joints: Vec<Joint>,
    pub(super) steps: Vec<Step>,
    /// What moves with each joint, in that joint's frame.
    pub(super) bodies: Vec<Inertia>,
    pub(super) links: Vec<Link>,
    /// The tool's frame, seen from the last joint's frame.
    pub(super) tool: Pose,
    pub(super) tool_name: String,
    /// What it was read from.
    pub(super) robot: Arc<Robot>,
}

impl Chain {
    /// The joints from base to tool.
    pub fn joints(&self) -> &[Joint] {
        &self.joints
    }

    /// Number of joints, at least one.
    pub fn joint_count(&self) -> usize {
        self.joints.len()
    }

    /// Joints that move nothing that weighs: the file gives no link beyond them a mass.
    pub fn weightless(&self) -> Vec<&str> {
        let loaded = self.bodies.iter().rposition(|body| body.mass_kg() > 0.0).map_or(0, |last| last + 1);
        self.joints.iter().skip(loaded).map(|joint| joint.name.as_str()).collect()
    }

    /// Name of the link whose frame is the tool's.
    pub fn tool_name(&self) -> &str {
        &self.tool_name
    }

    /// Names of the links on the way to the tool, in the order of [`Chain::link_poses`].
    pub fn link_names(&self) -> impl Iterator<Item = &str> {
        self.links.iter().map(|link| link.name.as_str())
    }

    /// Whether each of these links moves against the one before it; the base does not.
    pub fn link_moves(&self) -> impl Iterator<Item = bool> {
        let before = std::iter::once(0).chain(self.links.iter().map(|link| link.frame));
        self.links.iter().zip(before).map(|(link, before)| link.frame > before)
    }

    /// What the last joint carries: its own body and a payload, given in the tool's frame.
    pub fn load(&self, payload: Option<&Inertia>) -> Load {
        let own = self.bodies.last().copied().unwrap_or_default();
        Load(payload.map_or(own, |payload| own.with(&payload.seen_from(&self.tool))))
    }
}

/// What the last joint carries; made by [`Chain::load`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Load(pub(super) Inertia);

/// A chain in the making, from the base outwards.
pub(super) struct Builder {
    chain: Chain,
    /// The frame of the link reached last, seen from the frame of the joint reached last.
    here: Pose,
}

impl Builder {
    pub(super) fn new(robot: Arc<Robot>, base: &str) -> Self {
        let chain = Chain {
            joints: Vec::new(),
            steps: Vec::new(),
            bodies: Vec::new(),
            links: Vec::new(),
            tool: Pose::identity(),
            tool_name: String::new(),
            robot,
        };
        let mut builder = Self { chain, here: Pose::identity() };
        builder.name_link(base);
        builder
    }

    /// Goes on by a joint that is no joint.
    pub(super) fn fixed(&mut self, origin: &Pose, link: &str) {
        self.here *= origin;
        self.name_link(link);
    }

    /// Goes on by a joint that turns, or slides.
    pub(super) fn moving(&mut self, joint: Joint, origin: &Pose, axis: &Unit<Vector3<f64>>, link: &str) {
        let align = onto_axis(axis);
        let place = self.here * origin * align;
        let (rotation, offset_m) = (*place.rotation.matrix(), place.translation.vector);
        let slides = joint.kind == JointKind::Slides;
        self.chain.steps.push(Step { rotation, offset_m, slides });
        self.chain.joints.push(joint);
        self.chain.bodies.push(Inertia::default());
        self.here = align.inverse();
        self.name_link(link);
    }

    /// Adds mass to the link reached last; what the base carries does not matter.
    pub(super) fn body(&mut self, body: &Inertia, place: &Pose) {
        if let Some(last) = self.chain.bodies.last_mut() {
            *last = last.with(&body.seen_from(&(self.here * place)));
        }
    }

    pub(super) fn joint_count(&self) -> usize {
        self.chain.joints.len()
    }

    /// The chain; its tool is the link reached last.
    pub(super) fn finish(mut self) -> Chain {
        self.chain.tool = self.here;
        self.chain.tool_name = self.chain.links.last().map(|link| link.name.clone()).unwrap_or_default();
        self.chain
    }

    fn name_link(&mut self, name: &str) {
        let frame = self.joint_count();
        self.chain.links.push(Link { name: name.to_owned(), frame, place: self.here });
    }
}

/// A frame at the origin whose z axis is the axis given.
fn onto_axis(axis: &Unit<Vector3<f64>>) -> Pose {
    let half_turn = || Rotation3::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI);
    let rotation = Rotation3::rotation_between(&Vector3::z(), axis).unwrap_or_else(half_turn);
    Pose::from_parts(Translation3::identity(), rotation)
}
