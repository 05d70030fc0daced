//! The text of a URDF for tools that draw: with solids where the arm's own has none, and once more as a
//! ghost, to be shown beside itself.

use urdf_rs::{Color, Geometry, Material, Pose as Origin, Vec3, Vec4, Visual};

use super::{ArmError, Chain, Pose, Shape, Solid};

/// Stands before the names of all links and joints of a ghost.
pub const GHOST: &str = "planned/";

/// A ghost's colour; red, green, blue and opacity.
pub const GHOST_RGBA: [f64; 4] = [0.55, 0.78, 1.0, 0.35];

/// How much a ghost's solids are larger on every side by the reach of the arm, so that the two never
/// show at the same place.
const MARGIN: f64 = 0.004;

impl Chain {
    /// The URDF that the arm was read from, as far as tools that draw need it. Solids stand in where it
    /// has nothing to be seen.
    ///
    /// # Errors
    ///
    /// [`ArmError::Syntax`] for names that no URDF can hold.
    pub fn description(&self) -> Result<String, ArmError> {
        written(&self.dressed())
    }

    /// The same arm pale and translucent, with [`GHOST`] before the names of its links and joints.
    ///
    /// # Errors
    ///
    /// As [`Chain::description`].
    pub fn ghost_description(&self) -> Result<String, ArmError> {
        let mut robot = self.dressed();
        let margin_m = MARGIN * self.reach_m();
        let prefix = |name: &mut String| name.insert_str(0, GHOST);
        robot.name = format!("planned {}", robot.name);
        robot.materials.clear();
        for link in &mut robot.links {
            prefix(&mut link.name);
            for visual in &mut link.visual {
                visual.geometry = larger(&visual.geometry, margin_m);
                visual.material = Some(material("ghost", GHOST_RGBA));
            }
        }
        for joint in &mut robot.joints {
            prefix(&mut joint.name);
            prefix(&mut joint.parent.link);
            prefix(&mut joint.child.link);
        }
        written(&robot)
    }

    fn dressed(&self) -> urdf_rs::Robot {
        let mut robot = urdf_rs::Robot::clone(&self.robot);
        robot.links.iter_mut().for_each(|link| link.collision.clear());
        if robot.links.iter().all(|link| link.visual.is_empty()) {
            let names: Vec<&str> = self.link_names().collect();
            for shape in self.plain_shapes() {
                let name = names.get(shape.link);
                if let Some(link) = robot.links.iter_mut().find(|link| Some(&link.name.as_str()) == name) {
                    link.visual.push(visual(&shape));
                }
            }
        }
        robot
    }
}

fn written(robot: &urdf_rs::Robot) -> Result<String, ArmError> {
    urdf_rs::write_to_string(robot)
        .map_err(|error| ArmError::Syntax { file: "robot description".to_owned(), reason: error.to_string() })
}

fn visual(shape: &Shape) -> Visual {
    let geometry = match shape.solid {
        Solid::Block(size) => Geometry::Box { size: Vec3(size) },
        Solid::Cylinder { radius_m, length_m } => Geometry::Cylinder { radius: radius_m, length: length_m },
        Solid::Ball(radius) => Geometry::Sphere { radius },
    };
    let name = shape.rgba.map(|c| format!("{c:.2}")).join(" ");
    Visual { name: None, origin: origin(&shape.place), geometry, material: Some(material(&name, shape.rgba)) }
}

fn origin(place: &Pose) -> Origin {
    let (roll, pitch, yaw) = place.rotation.euler_angles();
    Origin { xyz: Vec3(place.translation.vector.into()), rpy: Vec3([roll, pitch, yaw]) }
}

fn material(name: &str, rgba: [f64; 4]) -> Material {
    Material { name: name.to_owned(), color: Some(Color { rgba: Vec4(rgba) }), texture: None }
}

fn larger(geometry: &Geometry, margin_m: f64) -> Geometry {
    match geometry {
        Geometry::Box { size } => Geometry::Box { size: Vec3(size.0.map(|edge| edge + 2.0 * margin_m)) },
        Geometry::Cylinder { radius, length } => {
            Geometry::Cylinder { radius: radius + margin_m, length: length + 2.0 * margin_m }
        }
        Geometry::Capsule { radius, length } => {
            Geometry::Capsule { radius: radius + margin_m, length: *length }
        }
        Geometry::Sphere { radius } => Geometry::Sphere { radius: radius + margin_m },
        mesh @ Geometry::Mesh { .. } => mesh.clone(),
    }
}
