//! What an arm looks like: the solids of its description, or plain ones where it has none.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{Rotation3, Translation3, UnitQuaternion, Vector3};

use super::{
    Chain, Pose,
    robot::{Body, Joint, JointKind, Origin, Visual},
};
use crate::series;

/// A body without a mesh, about the origin of its frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Solid {
    /// A block by its edges along x, y and z, m.
    Block([f64; 3]),
    /// A cylinder along z, m.
    Cylinder {
        /// Its radius, m.
        radius_m: f64,
        /// Its length, m.
        length_m: f64,
    },
    /// A ball by its radius, m.
    Ball(f64),
}

/// A solid that rides on a link.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shape {
    /// The link, counted as in [`Chain::link_poses`].
    pub link: usize,
    /// Its frame, seen from the link's.
    pub place: Pose,
    /// What it is.
    pub solid: Solid,
    /// Red, green, blue and opacity, 0 to 1.
    pub rgba: [f64; 4],
}

/// A mesh that rides on a link.
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh {
    /// The link, counted as in [`Chain::link_poses`].
    pub link: usize,
    /// Its frame, seen from the link's.
    pub place: Pose,
    /// Where its file lies, as the description says: `package://`, `file://` or a path.
    pub uri: String,
    /// Metres a unit of the file along x, y and z.
    pub scale: [f64; 3],
    /// Red, green, blue and opacity, 0 to 1; `None` leaves it to the file.
    pub rgba: Option<[f64; 4]>,
}

/// Width of the first link by the reach of the arm; the last one is half as wide.
const WIDTH: f64 = 0.04;
/// A pin's radius by the width of its link, and its length by the same.
const PIN: [f64; 2] = [0.6, 1.35];

struct Seen {
    link: usize,
    place: Pose,
    rgba: Option<[f64; 4]>,
}

const PAINT: [f64; 4] = [0.93, 0.53, 0.10, 1.0];
const STEEL: [f64; 4] = [0.29, 0.31, 0.35, 1.0];

impl Chain {
    /// The solids of the description, those on fixed branches included. Where `meshes` are drawn
    /// beside them and others are not, and of an arm that has nothing else to be seen: blocks from link
    /// to link, a pin at every joint and a ball at the tool.
    pub fn shapes(&self, meshes: &[Mesh]) -> Vec<Shape> {
        let mut shapes: Vec<Shape> = self.visuals(|visual, seen| {
            let solid = solid(&visual.geometry.body)?;
            let rgba = seen.rgba.unwrap_or(PAINT);
            Some(Shape { link: seen.link, place: seen.place, solid, rgba }).filter(sane)
        });
        if shapes.is_empty() && meshes.is_empty() {
            return self.plain_shapes();
        }
        let drawn = meshes.iter().map(|mesh| mesh.link).chain(shapes.iter().map(|shape| shape.link));
        let mut bare: BTreeSet<usize> = self.meshes().iter().map(|mesh| mesh.link).collect();
        drawn.for_each(|link| {
            bare.remove(&link);
        });
        shapes.extend(self.plain_shapes().into_iter().filter(|shape| bare.contains(&shape.link)));
        shapes
    }

    /// The meshes of the description, those on fixed branches included.
    pub fn meshes(&self) -> Vec<Mesh> {
        self.visuals(|visual, seen| {
            let Body::Mesh { filename, scale } = &visual.geometry.body else { return None };
            let scale = scale.unwrap_or([1.0; 3]);
            let numbers = scale.iter().chain(seen.place.translation.vector.iter());
            let sane = numbers.chain(seen.place.rotation.matrix()).all(|v| v.is_finite());
            let Seen { link, place, rgba } = seen;
            sane.then(|| Mesh { link, place, uri: filename.clone(), scale, rgba })
        })
    }

    fn visuals<T>(&self, of: impl Fn(&Visual, Seen) -> Option<T>) -> Vec<T> {
        let riders = self.riders();
        let colours: BTreeMap<&str, [f64; 4]> = (self.robot.materials.iter())
            .chain(self.robot.links.iter().flat_map(|link| &link.visual).filter_map(|v| v.material.as_ref()))
            .filter_map(|material| Some((material.name.as_str(), material.color.as_ref()?.rgba)))
            .collect();
        let mut found = Vec::new();
        for link in &self.robot.links {
            let Some(&(index, place)) = riders.get(link.name.as_str()) else { continue };
            for visual in &link.visual {
                let own = visual.material.as_ref().and_then(|m| Some(m.color.as_ref()?.rgba));
                let named = visual.material.as_ref().and_then(|m| colours.get(m.name.as_str()).copied());
                let rgba = own.or(named).filter(|rgba| rgba.iter().all(|c| c.is_finite()));
                found.extend(of(visual, Seen { link: index, place: place * pose(&visual.origin), rgba }));
            }
        }
        found
    }

    /// Every link that moves with one on the way to the tool, and where it is seen from there.
    fn riders(&self) -> BTreeMap<&str, (usize, Pose)> {
        let mut riders: BTreeMap<&str, (usize, Pose)> =
            self.link_names().enumerate().map(|(i, name)| (name, (i, Pose::identity()))).collect();
        let fixed = |joint: &&Joint| joint.kind == JointKind::Fixed;
        // The joints need not be in order; every round places at least one more link, or ends it.
        loop {
            let before = riders.len();
            for joint in self.robot.joints.iter().filter(fixed) {
                let Some(&(index, place)) = riders.get(joint.parent.link.as_str()) else { continue };
                riders
                    .entry(joint.child.link.as_str())
                    .or_insert_with(|| (index, place * pose(&joint.origin)));
            }
            if riders.len() == before {
                return riders;
            }
        }
    }

    /// Longest way from the base to the tool along the links, m, with joints that slide where their range ends.
    pub fn reach_m(&self) -> f64 {
        let slides = self.joints.iter().filter(|joint| joint.kind == series::JointKind::Slides);
        let slid_m = slides.map(|joint| joint.limit.upper_rad).filter(|m| m.is_finite()).sum::<f64>();
        let offset_m = self.steps.iter().map(|step| step.offset_m.norm()).sum::<f64>();
        offset_m + slid_m.max(0.0) + self.tool.translation.vector.norm()
    }

    pub(super) fn plain_shapes(&self) -> Vec<Shape> {
        let poses = self.link_poses(&[]);
        let last = poses.len().saturating_sub(1);
        let width_m = |i: usize| WIDTH * self.reach_m() * (1.0 - 0.5 * i as f64 / last.max(1) as f64);
        let mut shapes = Vec::new();
        let links = self.links.iter().zip(self.link_moves()).zip(&poses);
        for (i, ((link, moves), pose)) in links.enumerate() {
            let width_m = width_m(i);
            if moves {
                let [radius_m, length_m] = PIN.map(|share| share * width_m);
                let solid = Solid::Cylinder { radius_m, length_m };
                shapes.push(Shape { link: i, place: link.place.inverse(), solid, rgba: STEEL });
            }
            let rgba = if link.frame == 0 { STEEL } else { PAINT };
            if let Some(next) = poses.get(i + 1) {
                let way_m = pose.inv_mul(next).translation.vector;
                let along = Rotation3::rotation_between(&Vector3::x(), &way_m)
                    .unwrap_or_else(|| Rotation3::from_axis_angle(&Vector3::z_axis(), std::f64::consts::PI));
                let place = Pose::from_parts(Translation3::from(0.5 * way_m), along);
                let solid = Solid::Block([way_m.norm(), width_m, width_m]);
                if way_m.norm() > 1e-6 {
                    shapes.push(Shape { link: i, place, solid, rgba });
                }
            } else {
                let (place, solid) = (Pose::identity(), Solid::Ball(0.6 * width_m));
                shapes.push(Shape { link: i, place, solid, rgba: STEEL });
            }
        }
        shapes
    }
}

fn solid(body: &Body) -> Option<Solid> {
    match *body {
        Body::Box { size } => Some(Solid::Block(size)),
        Body::Cylinder { radius, length } | Body::Capsule { radius, length } => {
            Some(Solid::Cylinder { radius_m: radius, length_m: length })
        }
        Body::Sphere { radius } => Some(Solid::Ball(radius)),
        Body::Mesh { .. } => None,
    }
}

fn sane(shape: &Shape) -> bool {
    let mut place = shape.place.translation.vector.iter().chain(shape.place.rotation.matrix());
    let sizes = match shape.solid {
        Solid::Block(edges_m) => edges_m,
        Solid::Cylinder { radius_m, length_m } => [radius_m, length_m, 0.0],
        Solid::Ball(radius_m) => [radius_m, 0.0, 0.0],
    };
    place.all(|v| v.is_finite()) && sizes.iter().all(|v| v.is_finite() && *v >= 0.0)
}

fn pose(origin: &Origin) -> Pose {
    let ([x, y, z], [roll, pitch, yaw]) = (origin.xyz, origin.rpy);
    Pose::from_parts(Translation3::new(x, y, z), Rotation3::from_euler_angles(roll, pitch, yaw))
}

/// A frame's orientation as a unit quaternion x, y, z, w.
pub fn quaternion_xyzw(pose: &Pose) -> [f64; 4] {
    let q = UnitQuaternion::from_rotation_matrix(&pose.rotation);
    [q.i, q.j, q.k, q.w]
}
