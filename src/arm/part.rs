//! Of a robot that is more than an arm, the arm that some joints move.

use std::{
    collections::{BTreeMap, BTreeSet},
    sync::Arc,
};

use super::{
    ArmError, Chain,
    error::Witness,
    robot::{Joint, JointKind, Robot},
    urdf::{Tree, parsed},
};

impl Chain {
    /// Reads the arm that some joints move, whatever else the robot has, and names the joints on the way to
    /// its tool that could turn or slide but are none of these: they, and all beside the way, stand at zero.
    /// Of several arms it is the one that most of the joints move.
    ///
    /// # Errors
    ///
    /// As [`Chain::from_urdf`], but for what the robot may have beside one arm.
    pub fn of_joints(text: &str, file: &str, names: &[&str]) -> Result<(Self, Vec<String>), ArmError> {
        let at = Witness(file);
        let mut robot = parsed(text, &at)?;
        let (last, still) = hold_others(&mut robot, names);
        let robot = Arc::new(robot);
        let tree = Tree::new(&robot, at)?;
        Ok((tree.chain(tree.end(&last))?, still))
    }
}

/// Fixes all joints but those of the arm that most of the named ones move; returns the link that the last of
/// these moves, and the names of other joints on the way to it.
fn hold_others(robot: &mut Robot, names: &[&str]) -> (String, Vec<String>) {
    let moves = |joint: &Joint| {
        joint.kind.moves().is_some() && joint.mimic.is_none() && names.contains(&joint.name.as_str())
    };
    let arm = longest_way(robot, &moves);
    let moving: BTreeSet<usize> = arm.iter().copied().filter(|i| moves(&robot.joints[*i])).collect();
    let last = arm.first().and_then(|i| robot.joints.get(*i)).map(|joint| joint.child.link.clone());
    let mut still = Vec::new();
    for (i, joint) in robot.joints.iter_mut().enumerate() {
        if !moving.contains(&i) && joint.kind != JointKind::Fixed {
            if arm.contains(&i) {
                still.push(joint.name.clone());
            }
            joint.kind = JointKind::Fixed;
            joint.mimic = None;
        }
    }
    (last.unwrap_or_default(), still)
}

/// Of all ways from the root the one with most of the joints wanted, its last joint first, which is one of them.
pub(super) fn longest_way(robot: &Robot, wanted: &dyn Fn(&Joint) -> bool) -> Vec<usize> {
    let above: BTreeMap<&str, usize> =
        robot.joints.iter().enumerate().map(|(i, joint)| (joint.child.link.as_str(), i)).collect();
    // Joints from one to the root, itself included; one in a loop is reported later.
    let way = |last: usize| {
        let next = |&i: &usize| above.get(robot.joints.get(i)?.parent.link.as_str()).copied();
        std::iter::successors(Some(last), next).take(robot.joints.len()).collect::<Vec<usize>>()
    };
    let ways = (0..robot.joints.len()).filter(|i| wanted(&robot.joints[*i])).map(way);
    let count = |way: &Vec<usize>| way.iter().filter(|i| wanted(&robot.joints[**i])).count();
    // The first of the longest, for the sake of one answer.
    ways.rev().max_by_key(count).unwrap_or_default()
}
