//! The text of a URDF for tools that draw: with solids where the arm's own has none, and once more as a
//! ghost, to be shown beside itself.

use serde::Serialize as _;

use super::{
    ArmError, Chain, Shape, Solid,
    error::Witness,
    robot::{Body, Color, Geometry, Material, Origin, Robot, Visual},
};

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
                enlarge(&mut visual.geometry.body, margin_m);
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

    fn dressed(&self) -> Robot {
        let mut robot = Robot::clone(&self.robot);
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

fn written(robot: &Robot) -> Result<String, ArmError> {
    let mut text = String::new();
    let mut serializer = quick_xml::se::Serializer::new(&mut text);
    serializer.indent(' ', 2);
    let written = robot.serialize(serializer);
    written.map(|_| text).map_err(|error| Witness("robot description").syntax(&error))
}

fn visual(shape: &Shape) -> Visual {
    let body = match shape.solid {
        Solid::Block(size) => Body::Box { size },
        Solid::Cylinder { radius_m, length_m } => Body::Cylinder { radius: radius_m, length: length_m },
        Solid::Ball(radius) => Body::Sphere { radius },
    };
    let name = shape.rgba.map(|c| format!("{c:.2}")).join(" ");
    let (roll, pitch, yaw) = shape.place.rotation.euler_angles();
    let xyz = shape.place.translation.vector.into();
    let origin = Origin { xyz, rpy: [roll, pitch, yaw], quat_xyzw: None };
    let material = Some(material(&name, shape.rgba));
    Visual { name: None, origin, geometry: Geometry { body }, material }
}

fn material(name: &str, rgba: [f64; 4]) -> Material {
    Material { name: name.to_owned(), color: Some(Color { rgba }) }
}

fn enlarge(body: &mut Body, margin_m: f64) {
    match body {
        Body::Box { size } => *size = size.map(|edge| edge + 2.0 * margin_m),
        Body::Cylinder { radius, length } => {
            *radius += margin_m;
            *length += 2.0 * margin_m;
        }
        Body::Capsule { radius, .. } | Body::Sphere { radius } => *radius += margin_m,
        Body::Mesh { .. } => {}
    }
}
