//! From the text of a URDF to a [`Chain`]: the path from the root link to the tool, with fixed
//! joints folded and the masses of fixed side branches added to what carries them.

use std::{
    collections::{BTreeMap, BTreeSet},
    sync::Arc,
};

use nalgebra::{Matrix3, Rotation3, Translation3, Unit, Vector3};
use quick_xml::{Reader, events::Event};

use super::{
    ArmError, Chain, Inertia, Joint, JointLimit, Pose,
    chain::Builder,
    error::Witness,
    robot::{self, JointKind, Origin, Robot},
};

/// More than any description of an arm; meshes lie outside the text.
const LARGEST_TEXT: usize = 4 << 20;
/// The parser is recursive; a URDF nests five deep.
const DEEPEST: usize = 32;
/// Joints of one file, fixed ones included.
const MOST_JOINTS: usize = 4096;
/// A limit beyond is in millimetres, m: no crane's rails are so long.
const LONGEST_M: f64 = 1000.0;
/// A limit between the two is in degrees, rad: of five to a hundred turns, and beyond are joints without stops.
const IN_DEGREES_RAD: [f64; 2] = [30.0, 720.0];

impl Chain {
    /// Reads the text of a URDF; `file` stands for it in errors.
    ///
    /// The tool is the link named, or the only link without children. Joints may be `revolute`,
    /// `continuous` or `prismatic`; axes need not be unit vectors.
    ///
    /// # Errors
    ///
    /// [`ArmError`], naming the element: text that is no URDF, links or joints that are missing, double or in a loop,
    /// several possible tools, moving joints beside the path to the tool, other kinds of joints, numbers that are not
    /// finite, limits upside down, in degrees or in millimetres.
    pub fn from_urdf(text: &str, file: &str, tool: Option<&str>) -> Result<Self, ArmError> {
        let at = Witness(file);
        let robot = Arc::new(parsed(text, &at)?);
        let tree = Tree::new(&robot, at)?;
        let tool = tree.tool(tool)?;
        tree.chain(tool)
    }
}

/// Names of the joints of a URDF that slide; none if the text is no URDF.
pub fn sliding_joints(text: &str) -> BTreeSet<String> {
    joints_of(text, JointKind::Prismatic).map(|joint| joint.name).collect()
}

/// Names of the joints of a URDF that turn without end stops; none if the text is no URDF.
pub fn continuous_joints(text: &str) -> BTreeSet<String> {
    joints_of(text, JointKind::Continuous).map(|joint| joint.name).collect()
}

fn joints_of(text: &str, kind: JointKind) -> impl Iterator<Item = robot::Joint> {
    let joints = parsed(text, &Witness("URDF")).map(|robot| robot.joints).unwrap_or_default();
    joints.into_iter().filter(move |joint| joint.kind == kind)
}

/// Limits, rad, of the joints of a URDF that turn between stops; none if the text is no URDF.
pub(super) fn turning_ranges(text: &str) -> BTreeMap<String, (f64, f64)> {
    let range = |joint: robot::Joint| (joint.name, (joint.limit.lower, joint.limit.upper));
    joints_of(text, JointKind::Revolute).map(range).collect()
}

pub(super) fn parsed(text: &str, at: &Witness<'_>) -> Result<Robot, ArmError> {
    at.at_most("bytes", text.len(), LARGEST_TEXT)?;
    at.at_most("nested elements", nesting(text, at)?, DEEPEST)?;
    let mut robot: Robot = quick_xml::de::from_str(text).map_err(|error| at.syntax(&error))?;
    robot.turn_quaternions();
    at.at_most("joints", robot.joints.len(), MOST_JOINTS)?;
    Ok(robot)
}

/// Depth of elements, by the parser that reads them.
fn nesting(text: &str, at: &Witness<'_>) -> Result<usize, ArmError> {
    let mut reader = Reader::from_str(text);
    let (mut depth, mut deepest) = (0_usize, 0);
    loop {
        let event = reader.read_event().map_err(|error| at.syntax(&error))?;
        if let Event::Start(element) | Event::Empty(element) = &event
            && element.name().as_ref().starts_with(b"xacro:")
        {
            let name = String::from_utf8_lossy(element.name().as_ref()).into_owned();
            return Err(at.unexpected(
                format!("<{name}>"),
                "xacro, which is no URDF yet",
                "what xacro makes of it",
            ));
        }
        match event {
            Event::Start(_) => depth += 1,
            Event::End(_) => depth = depth.saturating_sub(1),
            Event::Eof if depth == 0 => return Ok(deepest),
            Event::Eof => return Err(at.syntax(&"it ends within an element")),
            _ => {}
        }
        deepest = deepest.max(depth);
    }
}

pub(super) struct Tree<'a> {
    pub(super) at: Witness<'a>,
    robot: &'a Arc<Robot>,
    links: BTreeMap<&'a str, &'a robot::Link>,
    /// The joint that leads to each link but the root.
    above: BTreeMap<&'a str, &'a robot::Joint>,
    /// The joints that leave each link.
    below: BTreeMap<&'a str, Vec<&'a robot::Joint>>,
    pub(super) root: &'a str,
}

impl<'a> Tree<'a> {
    pub(super) fn new(robot: &'a Arc<Robot>, at: Witness<'a>) -> Result<Self, ArmError> {
        let mut links = BTreeMap::new();
        for link in &robot.links {
            if links.insert(link.name.as_str(), link).is_some() {
                return Err(at.unexpected(format!("<link {:?}>", link.name), "it twice", "distinct names"));
            }
        }
        let mut names = BTreeSet::new();
        let mut above = BTreeMap::new();
        let mut below: BTreeMap<&str, Vec<&robot::Joint>> = BTreeMap::new();
        for joint in &robot.joints {
            let element = format!("<joint {:?}>", joint.name);
            if !names.insert(joint.name.as_str()) {
                return Err(at.unexpected(element, "it twice", "distinct names"));
            }
            for (end, name) in [("parent", &joint.parent.link), ("child", &joint.child.link)] {
                if !links.contains_key(name.as_str()) {
                    return Err(at.unexpected(format!("{element} <{end}>"), name, "a link of this file"));
                }
            }
            let child = joint.child.link.as_str();
            if let Some(other) = above.insert(child, joint) {
                let found = format!("the joints {:?} and {:?} leading to it", other.name, joint.name);
                return Err(at.unexpected(format!("<link {child:?}>"), found, "one parent"));
            }
            below.entry(joint.parent.link.as_str()).or_default().push(joint);
        }
        let roots: Vec<&str> = links.keys().copied().filter(|name| !above.contains_key(name)).collect();
        let [root] = roots[..] else {
            let found = match roots.len() {
                0 if links.is_empty() => "no links".to_owned(),
                0 => "a loop of joints".to_owned(),
                n => format!("{n}: {}", roots.join(", ")),
            };
            return Err(at.unexpected("<robot>", found, "one link without parent"));
        };
        Ok(Self { at, robot, links, above, below, root })
    }

    fn leads_to(&self, link: &str) -> bool {
        let parent = |link: &&str| self.above.get(link).map(|joint| joint.parent.link.as_str());
        std::iter::successors(Some(link), parent).take(self.links.len()).any(|link| link == self.root)
    }

    fn children(&self, link: &str) -> &[&'a robot::Joint] {
        self.below.get(link).map_or(&[], Vec::as_slice)
    }

    /// The link asked for, or the only leaf of the tree.
    pub(super) fn tool(&self, wanted: Option<&str>) -> Result<&'a str, ArmError> {
        if let Some(wanted) = wanted {
            return self.links.get_key_value(wanted).map(|(name, _)| *name).ok_or_else(|| {
                let names: Vec<&str> = self.links.keys().copied().collect();
                self.at.unexpected("tool", wanted, format!("a link of this file ({})", names.join(", ")))
            });
        }
        let ring: Vec<&str> = self.links.keys().copied().filter(|link| !self.leads_to(link)).collect();
        if !ring.is_empty() {
            let found =
                format!("a ring of joints, to which nothing leads from {:?}: {}", self.root, ring.join(", "));
            return Err(self.at.unexpected("<robot>", found, "one link that leads to all others"));
        }
        let leaves = self.links.keys().copied().filter(|name| self.children(name).is_empty());
        // Frames of the base are moved by nothing; where nothing moves, each may be meant.
        let moves = |link: &&str| {
            self.path(link).is_ok_and(|path| path.iter().any(|joint| joint.kind.moves().is_some()))
        };
        let (moved, fixed): (Vec<&str>, Vec<&str>) = leaves.partition(moves);
        let leaves = if moved.is_empty() { fixed } else { moved };
        match leaves[..] {
            [leaf] => Ok(leaf),
            _ => Err(ArmError::SeveralTools {
                file: self.at.0.to_owned(),
                tools: {
                    // That before the fingers of a gripper.
                    let branch = Some(self.end(self.root)).filter(|end| *end != self.root && moves(end));
                    branch.into_iter().chain(leaves).map(str::to_owned).collect()
                },
            }),
        }
    }

    /// Where the links after one branch or end.
    pub(super) fn end(&self, link: &str) -> &'a str {
        let mut end = self.links.get_key_value(link).map_or(self.root, |(name, _)| *name);
        // As many steps as there are links: a file may hold a loop.
        for _ in 0..self.links.len() {
            let [only] = self.children(end) else { break };
            end = only.child.link.as_str();
        }
        end
    }

    /// Joints on the way to a link, the last one first.
    pub(super) fn path(&self, tool: &'a str) -> Result<Vec<&'a robot::Joint>, ArmError> {
        let mut path = Vec::new();
        let mut link = tool;
        while let Some(&joint) = self.above.get(link) {
            path.push(joint);
            link = joint.parent.link.as_str();
            if path.len() > self.links.len() {
                return Err(self.at.unexpected(format!("<link {tool:?}>"), "a loop of joints", "a tree"));
            }
        }
        Ok(path)
    }

    pub(super) fn chain(&self, tool: &'a str) -> Result<Chain, ArmError> {
        let mut path = self.path(tool)?;
        let mut builder = Builder::new(Arc::clone(self.robot), self.root);
        while let Some(joint) = path.pop() {
            let element = format!("<joint {:?}>", joint.name);
            let origin = self.pose(&joint.origin, &element)?;
            let child = joint.child.link.as_str();
            if joint.kind == JointKind::Fixed {
                builder.fixed(&origin, child);
            } else {
                builder.moving(self.joint(joint, &element)?, &origin, &self.axis(joint, &element)?, child);
            }
            self.bodies(child, path.last().map(|next| next.name.as_str()), &mut builder)?;
        }
        if builder.joint_count() == 0 {
            let found = format!("no joint that moves between {:?} and {tool:?}", self.root);
            return Err(self.at.unexpected("<robot>", found, "at least one"));
        }
        Ok(builder.finish())
    }

    /// Adds the masses of a link and of all that is fixed to it, but for the joint `onwards`. What moves beyond the tool, such
    /// as the fingers of a gripper, is held at zero.
    fn bodies(&self, link: &'a str, onwards: Option<&str>, builder: &mut Builder) -> Result<(), ArmError> {
        let mut waiting = vec![(link, Pose::identity())];
        while let Some((link, place)) = waiting.pop() {
            builder.body(&self.inertia(link)?.0, &(place * self.inertia(link)?.1));
            for joint in self.children(link) {
                if Some(joint.name.as_str()) == onwards {
                    continue;
                }
                let element = format!("<joint {:?}>", joint.name);
                if joint.kind != JointKind::Fixed && onwards.is_some() {
                    let found = "a moving joint beside the path to the tool";
                    let expected = "a serial chain; name another tool, or make this joint fixed";
                    return Err(self.at.unexpected(element, found, expected));
                }
                waiting.push((joint.child.link.as_str(), place * self.pose(&joint.origin, &element)?));
            }
        }
        Ok(())
    }

    /// A link's mass and the frame of its inertial element.
    fn inertia(&self, name: &str) -> Result<(Inertia, Pose), ArmError> {
        let element = format!("<link {name:?}> <inertial>");
        let Some(given) = self.links.get(name).map(|link| &link.inertial) else {
            return Ok((Inertia::default(), Pose::identity()));
        };
        let i = &given.inertia;
        let tensor = Matrix3::new(i.ixx, i.ixy, i.ixz, i.ixy, i.iyy, i.iyz, i.ixz, i.iyz, i.izz);
        let body = Inertia::new(given.mass.value, Vector3::zeros(), tensor).ok_or_else(|| {
            let found = format!("mass {} kg, inertia {i:?}", given.mass.value);
            self.at.unexpected(
                &element,
                found,
                "finite numbers, and neither mass nor moments of inertia negative",
            )
        })?;
        Ok((body, self.pose(&given.origin, &element)?))
    }

    pub(super) fn pose(&self, origin: &Origin, element: &str) -> Result<Pose, ArmError> {
        let ([x, y, z], [roll, pitch, yaw]) = (origin.xyz, origin.rpy);
        // Beyond this, sums and products of lengths would overflow.
        let sane = |v: &f64| v.abs() < 1e9;
        if ![x, y, z, roll, pitch, yaw].iter().all(sane) {
            let found = format!("xyz {:?}, rpy {:?}", origin.xyz, origin.rpy);
            return Err(self.at.unexpected(format!("{element} <origin>"), found, "numbers below 1e9"));
        }
        let rotation = Rotation3::from_euler_angles(roll, pitch, yaw);
        Ok(Pose::from_parts(Translation3::new(x, y, z), rotation))
    }

    pub(super) fn axis(&self, joint: &robot::Joint, element: &str) -> Result<Unit<Vector3<f64>>, ArmError> {
        let axis = Vector3::from(joint.axis.xyz);
        Unit::try_new(axis, 1e-9).filter(|unit| unit.iter().all(|v| v.is_finite())).ok_or_else(|| {
            self.at.unexpected(format!("{element} <axis>"), format!("{:?}", joint.axis.xyz), "a direction")
        })
    }

    fn joint(&self, joint: &robot::Joint, element: &str) -> Result<Joint, ArmError> {
        let given = &joint.limit;
        let (lower_rad, upper_rad) = match joint.kind {
            JointKind::Continuous => (f64::NEG_INFINITY, f64::INFINITY),
            JointKind::Revolute | JointKind::Prismatic => (given.lower, given.upper),
            other => {
                let expected = "revolute, continuous, prismatic or fixed";
                return Err(self.at.unexpected(element, format!("the type {}", other.name()), expected));
            }
        };
        if let Some(mimic) = &joint.mimic {
            let found = format!("<mimic> of {:?}", mimic.joint);
            let expected = "joints that move on their own: make one that follows another fixed, and let the other move as far as both";
            return Err(self.at.unexpected(element, found, expected));
        }
        let wrong =
            |found: &str, expected: &str| self.at.unexpected(format!("{element} <limit>"), found, expected);
        let found = if lower_rad.abs().max(upper_rad.abs()) > 0.0 {
            format!("lower {lower_rad} and upper {upper_rad}")
        } else {
            "no range".to_owned()
        };
        if lower_rad.is_nan() || upper_rad.is_nan() || lower_rad >= upper_rad {
            return Err(wrong(&found, "lower below upper, rad or m"));
        }
        let [least_rad, most_rad] = IN_DEGREES_RAD;
        let widest_rad = lower_rad.abs().max(upper_rad.abs());
        if joint.kind == JointKind::Revolute && widest_rad > least_rad && widest_rad <= most_rad {
            let turns = widest_rad / std::f64::consts::TAU;
            let expected = "radians: degrees times 0.0174533; a joint without stops is of type continuous";
            return Err(wrong(&format!("{found}, {turns:.0} turns"), expected));
        }
        if joint.kind == JointKind::Prismatic && widest_rad > LONGEST_M {
            return Err(wrong(&found, "metres: millimetres times 0.001"));
        }
        for (name, value) in [("velocity", given.velocity), ("effort", given.effort)] {
            if value < 0.0 {
                let expected = "a limit of zero, which says nothing, or more";
                return Err(wrong(&format!("{name} {value}"), expected));
            }
        }
        // The format's default, zero, means that nothing is said.
        let said = |value: f64| if value > 0.0 { value } else { f64::INFINITY };
        let (torque_nm, speed_rad_s) = (said(given.effort), said(given.velocity));
        let limit = JointLimit { lower_rad, upper_rad, torque_nm, speed_rad_s };
        let resists = joint.dynamics.map_or([0.0; 2], |found| [found.damping, found.friction]);
        Ok(Joint { name: joint.name.clone(), kind: joint.kind.moves().unwrap_or_default(), limit, resists })
    }
}
