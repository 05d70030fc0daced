//! The task file as it is written: degrees, millimetres of joints that slide, and names; every quantity with its unit in its
//! key.

use std::collections::BTreeMap;

use serde::Deserialize;
use toml::Spanned;

pub(super) type ByJoint = BTreeMap<String, f64>;

/// A limit of speed: one for both ways, or the lowest, below zero, and the highest.
#[derive(Deserialize, Clone, Copy)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(untagged, expecting = "a speed is expected, or the lowest and the highest: [-8.0, 12.0]")]
pub(super) enum Speed {
    Either(f64),
    Ways([f64; 2]),
}

/// A task: what an arm is to do.
#[derive(Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct Document {
    /// What people call it.
    pub(super) title: String,
    /// "sample" for the arm that comes with hydrotrace, or a URDF file, relative to this file.
    #[cfg_attr(test, schemars(with = "String"))]
    pub(super) arm: Spanned<String>,
    /// File of the arm's cylinders and pump, relative to this file; without it the arm has none.
    pub(super) hydraulics: Option<String>,
    /// The link of the URDF that is the tool, where it has several ends.
    pub(super) tool: Option<String>,
    /// Names of the joints, each once.
    #[cfg_attr(test, schemars(with = "Vec<String>"))]
    pub(super) joints: Spanned<Vec<String>>,
    /// Degree of the spline: 5, 6 (default) or 7.
    #[cfg_attr(test, schemars(with = "Option<u8>", range(min = 5, max = 7)))]
    pub(super) degree: Option<Spanned<u8>>,
    /// Payload at the start, kg.
    #[serde(default)]
    pub(super) payload_kg: f64,
    /// Size of the payload, m: a box that reaches from the tool's origin forward along its x axis;
    /// a point unless given.
    #[cfg_attr(test, schemars(with = "Option<[f64; 3]>"))]
    pub(super) payload_size_m: Option<Spanned<[f64; 3]>>,
    /// Shortest and longest time from one key point to the next, s, dwells excluded; 0.3 to 20 unless given.
    #[cfg_attr(test, schemars(with = "Option<[f64; 2]>"))]
    pub(super) interval_s: Option<Spanned<[f64; 2]>>,
    /// Arrival at each key point, s: the plan is evaluated and not optimised.
    #[cfg_attr(test, schemars(with = "Option<Vec<f64>>"))]
    pub(super) times_s: Option<Spanned<Vec<f64>>>,
    /// Key points, at least two.
    #[cfg_attr(test, schemars(with = "Vec<Point>", length(min = 2)))]
    #[serde(rename = "point")]
    pub(super) points: Vec<Spanned<Point>>,
    /// State in which the plan starts; at rest unless given.
    pub(super) start: Option<End>,
    /// State in which the plan ends; at rest unless given.
    pub(super) end: Option<End>,
    /// Limits beside the arm's own.
    #[serde(default)]
    pub(super) limits: Limits,
    /// Ceilings on the objectives.
    #[serde(default)]
    #[cfg_attr(test, schemars(schema_with = "ceilings"))]
    pub(super) objectives: BTreeMap<String, Spanned<f64>>,
    /// How the objectives weigh against each other, each scaled by its range over the front; not negative, not all
    /// zero; zero for those left out.
    #[serde(default)]
    #[cfg_attr(test, schemars(schema_with = "weights"))]
    pub(super) weights: Option<Spanned<BTreeMap<String, Spanned<f64>>>>,
}

/// A pose that the plan passes through; give the joints' positions or `tool`.
#[derive(Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct Point {
    /// What people call it.
    #[serde(default)]
    pub(super) name: String,
    /// Angle of every joint that turns.
    #[cfg_attr(test, schemars(with = "Option<ByJoint>"))]
    pub(super) angles_deg: Option<Spanned<ByJoint>>,
    /// Position of every joint that slides.
    #[cfg_attr(test, schemars(with = "Option<ByJoint>"))]
    pub(super) positions_mm: Option<Spanned<ByJoint>>,
    /// Where the tool is; the joints follow by inverse kinematics, near the key point before.
    pub(super) tool: Option<Tool>,
    /// How long the arm rests here, s; 0 only stops there.
    #[cfg_attr(test, schemars(with = "Option<f64>"))]
    pub(super) dwell_s: Option<Spanned<f64>>,
    /// Payload from the end of the dwell on, kg.
    #[cfg_attr(test, schemars(with = "Option<f64>"))]
    pub(super) payload_kg: Option<Spanned<f64>>,
}

/// The tool in the arm's plane.
#[derive(Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct Tool {
    /// Forward of the base, m.
    pub(super) x_m: f64,
    /// Above the base, m.
    pub(super) z_m: f64,
    /// Pitch, positive from forward to down.
    pub(super) pitch_deg: f64,
    /// Whether the joints keep the angles that inverse kinematics gives; a plan of free shape seeks better ones otherwise.
    #[serde(default)]
    pub(super) fixed_angles: bool,
}

/// State at one end of the plan; joints left out are at rest.
#[derive(Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct End {
    /// Speed by joint.
    #[cfg_attr(test, schemars(with = "Option<ByJoint>"))]
    pub(super) speed_deg_s: Option<Spanned<ByJoint>>,
    /// Speed by joint that slides.
    #[cfg_attr(test, schemars(with = "Option<ByJoint>"))]
    pub(super) speed_mm_s: Option<Spanned<ByJoint>>,
    /// Acceleration by joint.
    #[cfg_attr(test, schemars(with = "Option<ByJoint>"))]
    pub(super) acceleration_deg_s2: Option<Spanned<ByJoint>>,
    /// Acceleration by joint that slides.
    #[cfg_attr(test, schemars(with = "Option<ByJoint>"))]
    pub(super) acceleration_mm_s2: Option<Spanned<ByJoint>>,
    /// Jerk by joint; a quintic takes none.
    #[cfg_attr(test, schemars(with = "Option<ByJoint>"))]
    pub(super) jerk_deg_s3: Option<Spanned<ByJoint>>,
    /// Jerk by joint that slides; a quintic takes none.
    #[cfg_attr(test, schemars(with = "Option<ByJoint>"))]
    pub(super) jerk_mm_s3: Option<Spanned<ByJoint>>,
}

/// Limits; joints left out have those of the arm only.
#[derive(Deserialize, Default)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct Limits {
    /// Lowest and highest angle by joint.
    #[cfg_attr(test, schemars(with = "Option<BTreeMap<String, [f64; 2]>>"))]
    pub(super) range_deg: Option<Spanned<BTreeMap<String, [f64; 2]>>>,
    /// Lowest and highest position by joint that slides.
    #[cfg_attr(test, schemars(with = "Option<BTreeMap<String, [f64; 2]>>"))]
    pub(super) range_mm: Option<Spanned<BTreeMap<String, [f64; 2]>>>,
    /// Speed by joint: one for both ways, or the lowest, below zero, and the highest.
    #[cfg_attr(test, schemars(with = "Option<BTreeMap<String, Speed>>"))]
    pub(super) speed_deg_s: Option<Spanned<BTreeMap<String, Speed>>>,
    /// Speed by joint that slides: one for both ways, or the lowest, below zero, and the highest.
    #[cfg_attr(test, schemars(with = "Option<BTreeMap<String, Speed>>"))]
    pub(super) speed_mm_s: Option<Spanned<BTreeMap<String, Speed>>>,
    /// Acceleration by joint.
    #[cfg_attr(test, schemars(with = "Option<ByJoint>"))]
    pub(super) acceleration_deg_s2: Option<Spanned<ByJoint>>,
    /// Acceleration by joint that slides.
    #[cfg_attr(test, schemars(with = "Option<ByJoint>"))]
    pub(super) acceleration_mm_s2: Option<Spanned<ByJoint>>,
    /// Jerk by joint.
    #[cfg_attr(test, schemars(with = "Option<ByJoint>"))]
    pub(super) jerk_deg_s3: Option<Spanned<ByJoint>>,
    /// Jerk by joint that slides.
    #[cfg_attr(test, schemars(with = "Option<ByJoint>"))]
    pub(super) jerk_mm_s3: Option<Spanned<ByJoint>>,
    /// Torque by joint, N m.
    #[cfg_attr(test, schemars(with = "Option<ByJoint>"))]
    pub(super) torque_n_m: Option<Spanned<ByJoint>>,
    /// Force by joint that slides, N.
    #[cfg_attr(test, schemars(with = "Option<ByJoint>"))]
    pub(super) force_n: Option<Spanned<ByJoint>>,
    /// Speed of a cylinder's rod by joint, m/s.
    #[cfg_attr(test, schemars(with = "Option<ByJoint>"))]
    pub(super) rod_speed_m_s: Option<Spanned<ByJoint>>,
    /// Speed of the tool, m/s.
    #[cfg_attr(test, schemars(with = "Option<f64>"))]
    pub(super) tool_speed_m_s: Option<Spanned<f64>>,
}

#[cfg(test)]
fn closed(mut schema: schemars::Schema) -> schemars::Schema {
    schema.insert("additionalProperties".into(), false.into());
    schema
}

#[cfg(test)]
fn ceilings(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
    closed(super::objective::schema(|row| row.ceiling))
}

#[cfg(test)]
fn weights(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
    closed(super::objective::schema(|row| row.weight))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_committed_schema_is_that_of_the_task_file() {
        crate::schema::is_committed::<Document>("task.schema.json", "hydrotrace task");
    }
}
