//! The way from a robot's base to its tool by its geometry alone, over joints that turn or slide.

use std::sync::Arc;

use nalgebra::Vector3;

use super::{
    ArmError, Chain, Joint, JointLimit, Pose,
    chain::Builder,
    error::Witness,
    part::longest_way,
    robot::{self, JointKind as Kind},
    urdf::{Tree, parsed},
};
use crate::series::JointKind;

/// A serial arm of joints that turn or slide: where its tool is, and by how much each joint moves it. It has no masses.
#[derive(Debug, Clone)]
pub struct Kinematics(Chain);

impl Kinematics {
    /// Reads the way to a tool from the text of a URDF; `file` stands for it in errors. `known` are the joints
    /// whose positions are known, and how they move.
    ///
    /// The tool is the link named, or the end of the arm that most of the known joints move: where the links after
    /// the last of these end or branch.
    ///
    /// # Errors
    ///
    /// [`ArmError::JointsMissing`] where a joint on the way can move and is not known; otherwise as
    /// [`Chain::from_urdf`], but for what the robot has beside the way.
    pub fn from_urdf(
        text: &str,
        file: &str,
        tool: Option<&str>,
        known: &[(&str, JointKind)],
    ) -> Result<Self, ArmError> {
        let at = Witness(file);
        let robot = Arc::new(parsed(text, &at)?);
        let is_known = |joint: &robot::Joint| {
            joint.kind.moves().is_some_and(|kind| known.contains(&(joint.name.as_str(), kind)))
        };
        let last = longest_way(&robot, &is_known).first().map(|i| robot.joints[*i].child.link.as_str());
        let tree = Tree::new(&robot, at)?;
        let tool = if tool.is_some() { tree.tool(tool)? } else { tree.end(last.unwrap_or(tree.root)) };
        let path = tree.path(tool)?;
        let moving = || path.iter().filter(|joint| joint.kind != Kind::Fixed);
        if moving().count() == 0 {
            let found = format!("no joint that moves between {:?} and {tool:?}", tree.root);
            return Err(tree.at.unexpected("<robot>", found, "at least one"));
        }
        let unknown = moving().rev().filter(|joint| !is_known(joint)).map(|joint| joint.name.clone());
        missing(file, tool, unknown.collect())?;
        let mut builder = Builder::new(Arc::clone(&robot), tree.root);
        for joint in path.iter().rev() {
            let element = format!("<joint {:?}>", joint.name);
            let (origin, child) = (tree.pose(&joint.origin, &element)?, joint.child.link.as_str());
            match joint.kind.moves() {
                None => builder.fixed(&origin, child),
                Some(kind) => {
                    let free = Joint { name: joint.name.clone(), kind, limit: FREE, resists: [0.0; 2] };
                    builder.moving(free, &origin, &tree.axis(joint, &element)?, child);
                }
            }
        }
        Ok(Self(builder.finish()))
    }

    /// Of an arm.
    ///
    /// # Errors
    ///
    /// [`ArmError::JointsMissing`] where one of them is not known.
    pub fn of(chain: Chain, file: &str, known: &[(&str, JointKind)]) -> Result<Self, ArmError> {
        let is_known = |joint: &&Joint| known.contains(&(joint.name.as_str(), joint.kind));
        let unknown = chain.joints.iter().filter(|joint| !is_known(joint)).map(|joint| joint.name.clone());
        missing(file, &chain.tool_name, unknown.collect())?;
        Ok(Self(chain))
    }

    /// The joints from base to tool, and how they move.
    pub fn joints(&self) -> impl Iterator<Item = (&str, JointKind)> {
        self.0.joints.iter().map(|joint| (&*joint.name, joint.kind))
    }

    /// Name of the link whose frame is the tool's.
    pub fn tool_name(&self) -> &str {
        self.0.tool_name()
    }

    /// Pose of the tool in the base's frame, of positions in the order of the joints, rad or m; missing ones are zero.
    pub fn tool_pose(&self, position: &[f64]) -> Pose {
        self.0.tool_pose(position)
    }

    /// By how much each joint moves the tool's origin along the base's axes: m by the joint's unit, rad or m.
    pub fn tool_moves(&self, position: &[f64]) -> Vec<Vector3<f64>> {
        let jacobian = self.0.tool_jacobian(position);
        jacobian.column_iter().map(|column| column.fixed_rows::<3>(0).into_owned()).collect()
    }
}

const FREE: JointLimit = JointLimit {
    lower_rad: f64::NEG_INFINITY,
    upper_rad: f64::INFINITY,
    torque_nm: f64::INFINITY,
    speed_rad_s: f64::INFINITY,
};

fn missing(file: &str, tool: &str, joints: Vec<String>) -> Result<(), ArmError> {
    if joints.is_empty() {
        return Ok(());
    }
    Err(ArmError::JointsMissing { file: file.to_owned(), tool: tool.to_owned(), joints })
}
