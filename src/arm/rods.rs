//! Cylinders as logs have them: whose they are by their names, and the angle of the joint at a length that was logged.

use std::{collections::BTreeMap, fmt::Write as _};

use super::{ArmError, Linkage, cylinder::Drive, error::Witness, hydraulics::Document, urdf::turning_ranges};

/// Words that make a name that of a cylinder.
const CYLINDER: [&str; 9] =
    ["cylinder", "cyl", "zylinder", "rod", "piston", "ram", "stroke", "length", "extension"];

/// The cylinder of one joint, and what a log has of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rod {
    /// The triangle.
    pub linkage: Linkage,
    /// Length from mount to mount where a log has zero, m.
    pub zero_m: f64,
    /// Limits of the joint, rad, if they are known.
    pub range_rad: Option<(f64, f64)>,
}

impl Rod {
    /// The length that a log has at an angle, m, and its change, m/rad; `None` where the cylinder drives no joint.
    pub fn logged_at(&self, angle_rad: f64) -> Option<(f64, f64)> {
        let (length_m, by_angle) = self.linkage.length_at(angle_rad)?;
        Some((length_m - self.zero_m, by_angle))
    }

    /// The angle at a length that a log has, rad, and its change, rad/m; `None` where the mounts cannot be so far apart.
    pub fn angle_at(&self, logged_m: f64) -> Option<(f64, f64)> {
        self.linkage.angle_at(logged_m + self.zero_m)
    }

    /// The least and the largest length that a log can have, m.
    pub fn logged_range_m(&self) -> [f64; 2] {
        self.linkage.lengths_m().map(|length_m| length_m - self.zero_m)
    }
}

/// Cylinders by the name of their joint.
#[derive(Debug, Clone, PartialEq)]
pub struct Rods {
    turning: BTreeMap<String, Rod>,
    /// Travel of the rod by that of a joint that slides.
    sliding: BTreeMap<String, f64>,
}

impl Rods {
    /// Reads a file of cylinders, as [`Hydraulics::from_toml`](super::Hydraulics::from_toml), of any joints; `urdf` gives
    /// the limits of those that it has.
    ///
    /// # Errors
    ///
    /// [`ArmError`], naming joint and key; a linkage that passes its dead centre within the joint's limits has two angles
    /// of one length.
    pub fn from_toml(text: &str, file: &str, urdf: Option<&str>) -> Result<Self, ArmError> {
        let at = Witness(file);
        let document = Document::read(text, &at)?;
        let ranges = urdf.map(turning_ranges).unwrap_or_default();
        let (mut turning, mut sliding) = (BTreeMap::new(), BTreeMap::new());
        for (joint, entry) in &document.joint {
            let range_rad = ranges.get(joint).copied();
            match *document.cylinder(joint, entry, (None, range_rad), &at)?.drive() {
                Drive::Turns(linkage) => {
                    turning.insert(joint.clone(), Rod { linkage, zero_m: entry.sensor_zero_m, range_rad });
                }
                Drive::Slides(rod_per_travel) => {
                    sliding.insert(joint.clone(), rod_per_travel);
                }
            }
        }
        Ok(Self { turning, sliding })
    }

    /// The cylinder of a joint that turns.
    pub fn of(&self, joint: &str) -> Option<&Rod> {
        self.turning.get(joint)
    }

    /// Travel of the rod of a joint that slides by that of the joint.
    pub fn rod_per_travel(&self, joint: &str) -> Option<f64> {
        self.sliding.get(joint).copied()
    }

    /// The joints.
    pub fn joints(&self) -> impl Iterator<Item = &str> {
        self.turning.keys().chain(self.sliding.keys()).map(String::as_str)
    }

    /// The joint that a name in a log means: its own, else the only one of the same words but `joint` and those of
    /// cylinders, whatever their case.
    pub fn meant(&self, name: &str) -> Option<&str> {
        if let Some(joint) = self.joints().find(|joint| *joint == name) {
            return Some(joint);
        }
        let own = key(name);
        let mut alike = self.joints().filter(|joint| !own.is_empty() && key(joint) == own);
        alike.next().filter(|_| alike.next().is_none())
    }
}

/// Whether a name says that it is a cylinder's.
pub fn names_a_cylinder(name: &str) -> bool {
    words(name).split(' ').any(|word| CYLINDER.contains(&word))
}

/// Words of joints that slide along something, and their axes.
const SLIDING: [&str; 18] = [
    "telescope", "telescopic", "teleskop", "tele", "slide", "slider", "sliding", "prismatic", "linear",
    "carriage", "trolley", "katze", "fahrwerk", "feed", "vorschub", "rail", "gantry", "schlitten",
];
const AXES: [&str; 3] = ["x", "y", "z"];

/// Whether a name says that it is that of a joint that slides: `boom_telescope`, `x_axis`.
pub fn names_a_slide(name: &str) -> bool {
    let words = words(name);
    let mut own = words.split(' ').filter(|word| !["joint", "axis"].contains(word));
    own.clone().any(|word| SLIDING.contains(&word))
        || own.next().is_some_and(|first| AXES.contains(&first) && own.next().is_none())
}

/// Whether a name says of a length that it counts from the cylinder that is drawn in.
pub fn names_a_stroke(name: &str) -> bool {
    words(name).split(' ').any(|word| ["stroke", "extension"].contains(&word))
}

/// What is left of a name without the words for joints and cylinders.
fn key(name: &str) -> String {
    let words = words(name);
    let kept = words.split(' ').filter(|word| *word != "joint" && !CYLINDER.contains(word));
    kept.collect::<Vec<_>>().join(" ")
}

/// The words of a name in small letters, split where one has `_`, `-`, a blank or a capital after a small letter.
fn words(name: &str) -> String {
    let (mut words, mut small) = (String::new(), false);
    for c in name.chars() {
        if (c.is_uppercase() && small || !c.is_alphanumeric()) && !words.ends_with(' ') {
            words.push(' ');
        }
        if c.is_alphanumeric() {
            let _ = write!(words, "{}", c.to_lowercase());
        }
        small = c.is_lowercase();
    }
    words.trim().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rods(joints: &[&str]) -> Rods {
        let entry = "bore_m = 0.05\nrod_m = 0.03\na_m = 0.4\nb_m = 0.5\ndelta_rad = 1.0\nangle_sign = 1\n";
        let mut text = "supply_pressure_pa = 16e6\nreturn_pressure_pa = 1e6\nmechanical_efficiency = 0.9\n\
                        pump_flow_m3_s = 1e-3\n"
            .to_owned();
        for joint in joints {
            let _ = write!(text, "[joint.{joint:?}]\n{entry}");
        }
        Rods::from_toml(&text, "h.toml", None).unwrap()
    }

    #[test]
    fn a_cylinder_is_its_joints_by_the_words_of_its_name() {
        let rods = rods(&["boom", "stick_joint", "joint_3", "Left Grip", "left-grip"]);
        for (name, joint) in [
            ("boom", Some("boom")),
            ("boom_cylinder", Some("boom")),
            ("BoomCyl", Some("boom")),
            ("cylinder boom length", Some("boom")),
            ("Stick", Some("stick_joint")),
            ("stick_stroke", Some("stick_joint")),
            ("cylinder_3", Some("joint_3")),
            ("boom_2_cylinder", None),
            ("cylinder", None),
            ("left_grip_rod", None),
            ("left-grip", Some("left-grip")),
            ("", None),
        ] {
            assert_eq!(rods.meant(name), joint, "{name}");
        }
        assert!(names_a_cylinder("BOOM-STROKE") && !names_a_cylinder("boomstroke"));
        assert!(
            ["boom_telescope", "TeleskopArm", "x", "joint_y", "Z-axis"]
                .iter()
                .all(|name| names_a_slide(name))
        );
        assert!(["rx", "x_boom", "lift", "joint_1", ""].iter().all(|name| !names_a_slide(name)));
    }
}
