//! Definitions of messages whose bag holds none, as those of rosbag2 until Humble: the known one that the bytes of
//! a message fit.

use crate::log::{
    decode::{LayoutCache, Numbers, Program, Sink, Slot, Texts},
    schema::{Definition, plain_name},
    write::ros2msg,
};

const CONTROLLER_STATE: &str = "control_msgs/JointTrajectoryControllerState";

/// The points of a controller's state by version, whether those of several degrees of freedom follow, and a scale of
/// speed: since Jazzy, Iron, Humble, for a while in Galactic, before.
const STATES: [(&str, bool, bool); 5] = [
    ("reference feedback error output", true, true),
    ("reference feedback error output", true, false),
    ("reference feedback error output desired actual", true, false),
    ("desired actual error", true, false),
    ("desired actual error", false, false),
];

/// Types that are not among those of our own logs.
const OTHERS: [(&str, &str); 3] = [
    ("std_msgs/Float64", "float64 data\n"),
    ("std_msgs/Float32", "float32 data\n"),
    (
        "std_msgs/Float64MultiArray",
        "std_msgs/MultiArrayLayout layout\nfloat64[] data\n===\nMSG: std_msgs/MultiArrayLayout\n\
         std_msgs/MultiArrayDimension[] dim\nuint32 data_offset\n===\nMSG: std_msgs/MultiArrayDimension\n\
         string label\nuint32 size\nuint32 stride\n",
    ),
];

/// The definition of a type that fits a message; empty if none does.
pub(super) fn definition(type_name: &str, message: &[u8]) -> String {
    let plain = plain_name(type_name);
    let known = if plain == CONTROLLER_STATE {
        controller_states()
    } else if let Some((_, text)) = OTHERS.iter().find(|(name, _)| *name == plain) {
        vec![(*text).to_owned()]
    } else {
        vec![ros2msg(&plain)]
    };
    known.into_iter().find(|text| fits(type_name, text, message)).unwrap_or_default()
}

fn controller_states() -> Vec<String> {
    let own = ros2msg(CONTROLLER_STATE);
    let used = own.find("\nMSG:").and_then(|at| own[..at].rfind("===").map(|_| at));
    // The types that it uses follow a line of `=`.
    let used = used.map_or("", |at| &own[at + 1..]);
    let text = |(points, several, scale): (&str, bool, bool)| {
        let mut text = "std_msgs/Header header\nstring[] joint_names\n".to_owned();
        let points = || points.split(' ');
        text.extend(points().map(|point| format!("trajectory_msgs/JointTrajectoryPoint {point}\n")));
        if several {
            text.push_str("string[] multi_dof_joint_names\n");
            let line = |point| format!("trajectory_msgs/MultiDOFJointTrajectoryPoint multi_dof_{point}\n");
            text.extend(points().map(line));
        }
        if scale {
            text.push_str("float64 speed_scaling_factor\n");
        }
        format!("{text}===\n{used}")
    };
    STATES.map(text).into()
}

fn fits(type_name: &str, text: &str, message: &[u8]) -> bool {
    let program = Definition::parse(type_name, "ros2msg", text.as_bytes())
        .ok()
        .and_then(|definition| Program::compile(&definition, &[], usize::MAX).ok());
    !text.is_empty()
        && program.is_some_and(|p| p.run(message, &mut LayoutCache::default(), &mut Nothing).is_ok())
}

/// Wants nothing of a message.
struct Nothing;

impl Sink for Nothing {
    fn number(&mut self, _: Slot, _: f64) {}
    fn text(&mut self, _: Slot, _: &[u8]) {}
    fn numbers(&mut self, _: Slot, _: Numbers<'_>) {}
    fn texts(&mut self, _: Slot, _: Texts<'_>) {}
    fn element(&mut self, _: Slot) {}
    fn expected_texts(&self, _: Slot) -> Option<&[u8]> {
        None
    }
    fn same_texts(&mut self, _: Slot) {}
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_known_definition_can_be_read() {
        let all = controller_states().into_iter().map(|text| (CONTROLLER_STATE, text));
        let others = OTHERS.map(|(name, text)| (name, text.to_owned()));
        for (name, text) in all.chain(others) {
            let parsed = Definition::parse(name, "ros2msg", text.as_bytes());
            assert!(parsed.is_ok_and(|one| Program::compile(&one, &[], usize::MAX).is_ok()), "{text}");
        }
    }

    #[test]
    fn an_array_of_numbers_is_told_and_an_unknown_type_is_not() {
        let mut message = vec![0, 1, 0, 0];
        message.extend([0_u32.to_le_bytes(), 0_u32.to_le_bytes(), 1_u32.to_le_bytes(), [0; 4]].concat());
        message.extend(0.5_f64.to_le_bytes());
        assert!(
            definition("std_msgs/msg/Float64MultiArray", &message).starts_with("std_msgs/MultiArrayLayout")
        );
        assert_eq!(definition("std_msgs/msg/Float64MultiArray", &message[..16]), "");
        assert_eq!(definition("mine/msg/Own", &message), "");
    }
}
