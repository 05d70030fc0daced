//! The elements of a URDF, read and written by serde. Elements that this crate does not use are dropped.

use std::borrow::Cow;

use nalgebra::{Quaternion, UnitQuaternion};
use serde::{Deserialize, Deserializer, Serialize, de::Error};

use crate::series;

#[derive(Debug, Clone, Deserialize, Serialize)]
#[serde(rename = "robot")]
pub(super) struct Robot {
    #[serde(rename = "@name", default)]
    pub(super) name: String,
    #[serde(rename = "@version", default, skip_serializing_if = "Option::is_none")]
    version: Option<String>,
    #[serde(rename = "link", default)]
    pub(super) links: Vec<Link>,
    #[serde(rename = "joint", default)]
    pub(super) joints: Vec<Joint>,
    #[serde(rename = "material", default)]
    pub(super) materials: Vec<Material>,
}

#[derive(Debug, Clone, Deserialize, Serialize)]
pub(super) struct Link {
    #[serde(rename = "@name")]
    pub(super) name: String,
    #[serde(default)]
    pub(super) inertial: Inertial,
    #[serde(default)]
    pub(super) visual: Vec<Visual>,
}

#[derive(Debug, Clone, Default, Deserialize, Serialize)]
pub(super) struct Inertial {
    #[serde(default)]
    pub(super) origin: Origin,
    pub(super) mass: Mass,
    pub(super) inertia: Inertia,
}

#[derive(Debug, Clone, Default, Deserialize, Serialize)]
pub(super) struct Mass {
    #[serde(rename = "@value", deserialize_with = "number")]
    pub(super) value: f64,
}

#[derive(Debug, Clone, Default, Deserialize, Serialize)]
pub(super) struct Inertia {
    #[serde(rename = "@ixx", deserialize_with = "number")]
    pub(super) ixx: f64,
    #[serde(rename = "@ixy", deserialize_with = "number")]
    pub(super) ixy: f64,
    #[serde(rename = "@ixz", deserialize_with = "number")]
    pub(super) ixz: f64,
    #[serde(rename = "@iyy", deserialize_with = "number")]
    pub(super) iyy: f64,
    #[serde(rename = "@iyz", deserialize_with = "number")]
    pub(super) iyz: f64,
    #[serde(rename = "@izz", deserialize_with = "number")]
    pub(super) izz: f64,
}

#[derive(Debug, Clone, Deserialize, Serialize)]
pub(super) struct Visual {
    #[serde(rename = "@name", default, skip_serializing_if = "Option::is_none")]
    pub(super) name: Option<String>,
    #[serde(default)]
    pub(super) origin: Origin,
    pub(super) geometry: Geometry,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) material: Option<Material>,
}

#[derive(Debug, Clone, Deserialize, Serialize)]
pub(super) struct Geometry {
    #[serde(rename = "$value")]
    pub(super) body: Body,
}

#[derive(Debug, Clone, Deserialize, Serialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Body {
    Box {
        #[serde(rename = "@size", deserialize_with = "numbers")]
        size: [f64; 3],
    },
    Cylinder {
        #[serde(rename = "@radius", deserialize_with = "number")]
        radius: f64,
        #[serde(rename = "@length", deserialize_with = "number")]
        length: f64,
    },
    Capsule {
        #[serde(rename = "@radius", deserialize_with = "number")]
        radius: f64,
        #[serde(rename = "@length", deserialize_with = "number")]
        length: f64,
    },
    Sphere {
        #[serde(rename = "@radius", deserialize_with = "number")]
        radius: f64,
    },
    Mesh {
        #[serde(rename = "@filename")]
        filename: String,
        #[serde(rename = "@scale", default, deserialize_with = "some_numbers")]
        #[serde(skip_serializing_if = "Option::is_none")]
        scale: Option<[f64; 3]>,
    },
}

#[derive(Debug, Clone, Deserialize, Serialize)]
pub(super) struct Material {
    #[serde(rename = "@name")]
    pub(super) name: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) color: Option<Color>,
}

#[derive(Debug, Clone, Deserialize, Serialize)]
pub(super) struct Color {
    #[serde(rename = "@rgba", deserialize_with = "numbers")]
    pub(super) rgba: [f64; 4],
}

#[derive(Debug, Clone, Default, Deserialize, Serialize)]
pub(super) struct Origin {
    #[serde(rename = "@xyz", default, deserialize_with = "numbers")]
    pub(super) xyz: [f64; 3],
    #[serde(rename = "@rpy", default, deserialize_with = "numbers")]
    pub(super) rpy: [f64; 3],
    /// The other way to say `rpy`, since version 1.1.
    #[serde(rename = "@quat_xyzw", default, deserialize_with = "some_numbers", skip_serializing)]
    pub(super) quat_xyzw: Option<[f64; 4]>,
}

#[derive(Debug, Clone, Deserialize, Serialize)]
pub(super) struct Joint {
    #[serde(rename = "@name")]
    pub(super) name: String,
    #[serde(rename = "@type")]
    pub(super) kind: JointKind,
    #[serde(default)]
    pub(super) origin: Origin,
    pub(super) parent: End,
    pub(super) child: End,
    #[serde(default)]
    pub(super) axis: Axis,
    #[serde(default)]
    pub(super) limit: Limit,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) dynamics: Option<Dynamics>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) mimic: Option<Mimic>,
}

/// What a joint takes to move by itself: N m s/rad and N m, or N s/m and N.
#[derive(Debug, Clone, Copy, Default, Deserialize, Serialize)]
pub(super) struct Dynamics {
    #[serde(rename = "@damping", default, deserialize_with = "number")]
    pub(super) damping: f64,
    #[serde(rename = "@friction", default, deserialize_with = "number")]
    pub(super) friction: f64,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum JointKind {
    Revolute,
    Continuous,
    Prismatic,
    Fixed,
    Floating,
    Planar,
    Spherical,
}

impl JointKind {
    /// As the file has it.
    pub(super) fn name(self) -> String {
        format!("{self:?}").to_lowercase()
    }

    /// How a joint of one degree of freedom moves; `None` of the others.
    pub(super) fn moves(self) -> Option<series::JointKind> {
        match self {
            Self::Revolute | Self::Continuous => Some(series::JointKind::Turns),
            Self::Prismatic => Some(series::JointKind::Slides),
            Self::Fixed | Self::Floating | Self::Planar | Self::Spherical => None,
        }
    }
}

#[derive(Debug, Clone, Deserialize, Serialize)]
pub(super) struct End {
    #[serde(rename = "@link")]
    pub(super) link: String,
}

#[derive(Debug, Clone, Deserialize, Serialize)]
pub(super) struct Axis {
    #[serde(rename = "@xyz", deserialize_with = "numbers")]
    pub(super) xyz: [f64; 3],
}

impl Default for Axis {
    fn default() -> Self {
        Self { xyz: [1.0, 0.0, 0.0] }
    }
}

#[derive(Debug, Clone, Default, Deserialize, Serialize)]
pub(super) struct Limit {
    #[serde(rename = "@lower", default, deserialize_with = "number", skip_serializing_if = "is_infinite")]
    pub(super) lower: f64,
    #[serde(rename = "@upper", default, deserialize_with = "number", skip_serializing_if = "is_infinite")]
    pub(super) upper: f64,
    #[serde(rename = "@effort", default, deserialize_with = "number", skip_serializing_if = "is_infinite")]
    pub(super) effort: f64,
    #[serde(rename = "@velocity", default, deserialize_with = "number", skip_serializing_if = "is_infinite")]
    pub(super) velocity: f64,
}

#[derive(Debug, Clone, Deserialize, Serialize)]
pub(super) struct Mimic {
    #[serde(rename = "@joint")]
    pub(super) joint: String,
}

impl Robot {
    /// Turns every `quat_xyzw` into `rpy`; before version 1.1 it has no meaning.
    pub(super) fn turn_quaternions(&mut self) {
        let version = self.version.as_deref().and_then(|text| text.trim().split_once('.'));
        let version = version.and_then(|(major, minor)| Some((major.parse().ok()?, minor.parse().ok()?)));
        let given = version.is_some_and(|version: (u32, u32)| version >= (1, 1));
        let links = self.links.iter_mut();
        let of_links = links.flat_map(|link| {
            std::iter::once(&mut link.inertial.origin).chain(link.visual.iter_mut().map(|v| &mut v.origin))
        });
        for origin in of_links.chain(self.joints.iter_mut().map(|joint| &mut joint.origin)) {
            if let Some([x, y, z, w]) = origin.quat_xyzw.take().filter(|_| given) {
                let turn = UnitQuaternion::try_new(Quaternion::new(w, x, y, z), 0.0).unwrap_or_default();
                let (roll, pitch, yaw) = turn.euler_angles();
                origin.rpy = [roll, pitch, yaw];
            }
        }
    }
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "the form that serde calls")]
fn is_infinite(value: &f64) -> bool {
    value.is_infinite()
}

fn number<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    numbers(deserializer).map(|[number]| number)
}

fn some_numbers<'de, const N: usize, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<Option<[f64; N]>, D::Error> {
    numbers(deserializer).map(Some)
}

/// Numbers between blanks, as many as are wanted.
fn numbers<'de, const N: usize, D: Deserializer<'de>>(deserializer: D) -> Result<[f64; N], D::Error> {
    let text = Cow::<str>::deserialize(deserializer)?;
    let found: Result<Vec<f64>, _> = text.split_whitespace().map(str::parse).collect();
    let found = found.ok().and_then(|found| <[f64; N]>::try_from(found).ok());
    let what = if N == 1 { "a number".to_owned() } else { format!("{N} numbers") };
    let why = if text.contains("${") { ": this is xacro, which is no URDF yet: run xacro first" } else { "" };
    found.ok_or_else(|| D::Error::custom(format_args!("{text:?} is not {what}{why}")))
}
