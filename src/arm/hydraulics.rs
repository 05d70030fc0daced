//! The cylinders of a chain's joints and the pump they share, from a file.

use std::{collections::BTreeMap, f64::consts::PI};

use serde::Deserialize;

use super::{ArmError, Chain, Cylinder, Linkage, cylinder::Drive, error::Witness};
use crate::series::JointKind;

const LARGEST_TEXT: usize = 1 << 20;

/// The file as it is written: SI units and radians.
#[derive(Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct Document {
    /// Where the numbers come from.
    #[expect(dead_code, reason = "for people")]
    #[serde(default)]
    warning: Option<String>,
    /// Pressure before the valves, Pa.
    supply_pressure_pa: f64,
    /// Pressure behind the valves, Pa.
    return_pressure_pa: f64,
    /// Force at the joint by force on the piston, above 0, at most 1.
    mechanical_efficiency: f64,
    /// Largest flow of the pump, m³/s.
    pump_flow_m3_s: f64,
    /// Cylinders by the name of their joint.
    pub(super) joint: BTreeMap<String, Entry>,
}

/// Cylinders of one joint: of one that turns with a triangle (`a_m`, `b_m`, `delta_rad`, `angle_sign`), of one that slides with
/// `rod_per_travel`.
#[derive(Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct Entry {
    /// Inner diameter, m.
    bore_m: f64,
    /// Diameter of the rod, m.
    rod_m: f64,
    /// From the joint to the mount on the link before it, m.
    a_m: Option<f64>,
    /// From the joint to the mount on the link after it, m.
    b_m: Option<f64>,
    /// Angle between the mounts, seen from the joint, at joint angle zero, rad.
    delta_rad: Option<f64>,
    /// 1 where the angle between the mounts grows with the joint's angle, -1 where it shrinks.
    angle_sign: Option<i8>,
    /// Travel of the rod by that of a joint that slides: 1 where it moves it directly, 0.5 where chains double it, negative
    /// where it retracts as the joint's position grows.
    rod_per_travel: Option<f64>,
    /// How many like cylinders work side by side.
    #[serde(default = "one")]
    cylinders: u32,
    /// Length from mount to mount where a log has zero, m: 0 if logs have this length, that of the retracted cylinder if
    /// they have strokes.
    #[serde(default)]
    pub(super) sensor_zero_m: f64,
}

fn one() -> u32 {
    1
}

impl Entry {
    /// How it moves a joint, of that kind if it is known; else what was found and what is expected.
    fn drive(&self, kind: Option<JointKind>) -> Result<Drive, (String, &'static str)> {
        let triangle =
            [self.a_m.is_some(), self.b_m.is_some(), self.delta_rad.is_some(), self.angle_sign.is_some()];
        let any = triangle.contains(&true);
        match (self.rod_per_travel, self.a_m, self.b_m, self.delta_rad, self.angle_sign) {
            (Some(travel), ..) if !any && kind != Some(JointKind::Turns) => Ok(Drive::Slides(travel)),
            (None, Some(inner_m), Some(outer_m), Some(offset_rad), Some(sign))
                if kind != Some(JointKind::Slides) =>
            {
                Ok(Drive::Turns(Linkage { inner_m, outer_m, offset_rad, sense: f64::from(sign) }))
            }
            (straight, ..) => {
                let keys = ["a_m", "b_m", "delta_rad", "angle_sign"].into_iter().zip(triangle);
                let given = keys.filter(|(_, given)| *given).map(|(key, _)| key);
                let given: Vec<&str> = given.chain(straight.map(|_| "rod_per_travel")).collect();
                let found =
                    if given.is_empty() { "no key of its drive".to_owned() } else { given.join(", ") };
                let expected = match kind {
                    Some(JointKind::Turns) => "a_m, b_m, delta_rad and angle_sign, for the joint turns",
                    Some(JointKind::Slides) => "rod_per_travel alone, for the joint slides",
                    None => {
                        "a_m, b_m, delta_rad and angle_sign of a joint that turns, or rod_per_travel of one that slides"
                    }
                };
                Err((found, expected))
            }
        }
    }
}

impl Document {
    /// Reads the text and checks what all joints share.
    pub(super) fn read(text: &str, at: &Witness<'_>) -> Result<Self, ArmError> {
        at.at_most("bytes", text.len(), LARGEST_TEXT)?;
        let document: Self = toml::from_str(text).map_err(|error| at.syntax(&error))?;
        let Self { supply_pressure_pa: supply, return_pressure_pa: back, .. } = document;
        if !(back >= 0.0 && supply > back && supply < 1e9) {
            let found = format!("supply {supply} Pa and return {back} Pa");
            let expected = "a supply above the return, which is not negative";
            return Err(at.unexpected("supply_pressure_pa", found, expected));
        }
        let efficiency = document.mechanical_efficiency;
        if !(efficiency > 0.0 && efficiency <= 1.0) {
            return Err(at.unexpected("mechanical_efficiency", efficiency, "above 0, at most 1"));
        }
        let pump_flow_m3_s = document.pump_flow_m3_s;
        if !(pump_flow_m3_s > 0.0 && pump_flow_m3_s.is_finite()) {
            return Err(at.unexpected("pump_flow_m3_s", pump_flow_m3_s, "a flow above 0"));
        }
        Ok(document)
    }

    /// The cylinder of a joint that has such a range, rad; without one, its triangle is taken to reach it. `kind`: how the
    /// joint moves, if that is known.
    pub(super) fn cylinder(
        &self,
        joint: &str,
        entry: &Entry,
        (kind, range_rad): (Option<JointKind>, Option<(f64, f64)>),
        at: &Witness<'_>,
    ) -> Result<Cylinder, ArmError> {
        let drive = entry
            .drive(kind)
            .map_err(|(found, expected)| at.unexpected(format!("[joint.{joint}]"), found, expected))?;
        let size = (entry.bore_m, entry.rod_m, entry.cylinders);
        let pressures = (self.supply_pressure_pa, self.return_pressure_pa, self.mechanical_efficiency);
        let middle_rad = match drive {
            Drive::Turns(linkage) => linkage.sense * (0.5 * PI - linkage.offset_rad),
            Drive::Slides(_) => 0.0,
        };
        let range_rad = range_rad.unwrap_or((middle_rad, middle_rad));
        let unexpected =
            |key, found, expected| at.unexpected(format!("[joint.{joint}] {key}"), found, expected);
        if matches!(drive, Drive::Slides(_)) && entry.sensor_zero_m != 0.0 {
            let expected = "none of a joint that slides: its rod counts from where the joint is at zero";
            return Err(unexpected("sensor_zero_m", entry.sensor_zero_m.to_string(), expected));
        }
        if !(-1e3..1e3).contains(&entry.sensor_zero_m) {
            return Err(unexpected("sensor_zero_m", entry.sensor_zero_m.to_string(), "a length, m"));
        }
        Cylinder::new(drive, size, pressures, range_rad)
            .map_err(|(key, found, expected)| unexpected(key, found, expected))
    }
}

/// Cylinders of a chain, one or none a joint, and their pump.
#[derive(Debug, Clone, PartialEq)]
pub struct Hydraulics {
    cylinders: Vec<Option<Cylinder>>,
    pump_flow_m3_s: f64,
}

impl Hydraulics {
    pub(super) fn none(joints: usize) -> Self {
        Self { cylinders: vec![None; joints], pump_flow_m3_s: f64::INFINITY }
    }

    /// Reads the text of a file, TOML as `schemas/hydraulics.schema.json` describes it; `file`
    /// stands for it in errors. Joints without an entry have no cylinder.
    ///
    /// # Errors
    ///
    /// [`ArmError`], naming joint and key: unknown joints, numbers out of range, a linkage that
    /// passes its dead centre within the joint's range.
    pub fn from_toml(text: &str, file: &str, chain: &Chain) -> Result<Self, ArmError> {
        let at = Witness(file);
        let mut document = Document::read(text, &at)?;
        let mut entries = std::mem::take(&mut document.joint);
        let mut cylinders = Vec::with_capacity(chain.joint_count());
        for joint in chain.joints() {
            let Some(entry) = entries.remove(&joint.name) else {
                cylinders.push(None);
                continue;
            };
            let range_rad = (joint.limit.lower_rad, joint.limit.upper_rad);
            let known = (Some(joint.kind), Some(range_rad));
            cylinders.push(Some(document.cylinder(&joint.name, &entry, known, &at)?));
        }
        if let Some(name) = entries.keys().next() {
            let names: Vec<&str> = chain.joints().iter().map(|joint| joint.name.as_str()).collect();
            let expected = format!("a joint of the chain ({})", names.join(", "));
            return Err(at.unexpected("[joint]", name, expected));
        }
        Ok(Self { cylinders, pump_flow_m3_s: document.pump_flow_m3_s })
    }

    /// The cylinders by joint.
    pub fn cylinders(&self) -> &[Option<Cylinder>] {
        &self.cylinders
    }

    /// Largest flow of the pump, m³/s.
    pub fn pump_flow_m3_s(&self) -> f64 {
        self.pump_flow_m3_s
    }

    /// With a pump that gives no more than so much, m³/s.
    pub fn with_pump_flow_m3_s(self, most: f64) -> Self {
        Self { pump_flow_m3_s: self.pump_flow_m3_s.min(most), ..self }
    }
}

/// An arm: its mechanics and what drives it.
#[derive(Debug, Clone)]
pub struct Arm {
    /// Geometry and masses.
    pub chain: Chain,
    /// Cylinders and pump.
    pub hydraulics: Hydraulics,
}

impl Arm {
    /// Reads both texts, each named by the file it stands in; `tool` as in [`Chain::from_urdf`].
    ///
    /// # Errors
    ///
    /// As [`Chain::from_urdf`] and [`Hydraulics::from_toml`].
    pub fn new(urdf: (&str, &str), tool: Option<&str>, hydraulics: (&str, &str)) -> Result<Self, ArmError> {
        let chain = Chain::from_urdf(urdf.1, urdf.0, tool)?;
        let hydraulics = Hydraulics::from_toml(hydraulics.1, hydraulics.0, &chain)?;
        Ok(Self { chain, hydraulics })
    }

    /// An arm without cylinders, or of which nobody has described them.
    ///
    /// # Errors
    ///
    /// As [`Chain::from_urdf`].
    pub fn without_hydraulics(urdf: (&str, &str), tool: Option<&str>) -> Result<Self, ArmError> {
        let chain = Chain::from_urdf(urdf.1, urdf.0, tool)?;
        let hydraulics = Hydraulics::none(chain.joint_count());
        Ok(Self { chain, hydraulics })
    }

    /// The sample arm of `sample-logs/arm`: an assumption of this project, no machine that exists.
    ///
    /// # Errors
    ///
    /// None: the files are part of the program, and a test reads them.
    pub fn sample() -> Result<Self, ArmError> {
        Self::new(
            ("arm.urdf", include_str!("../../sample-logs/arm/arm.urdf")),
            Some("tool"),
            ("hydraulics.toml", include_str!("../../sample-logs/arm/hydraulics.toml")),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_committed_schema_is_that_of_the_file() {
        crate::schema::is_committed::<Document>("hydraulics.schema.json", "hydrotrace cylinders of an arm");
    }
}
