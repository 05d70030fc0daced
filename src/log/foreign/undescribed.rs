//! Definitions of messages whose bag holds none, as those of rosbag2 until Humble: the known one that the bytes of
//! a message fit.

use crate::log::{
    decode::{LayoutCache, Program, Sink, Slot},
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

/// Types that are not among those of our own logs, and what they use of such.
const OTHERS: [(&str, &str); 8] = [
    ("std_msgs/Float64", "float64 data\n"),
    ("std_msgs/Float32", "float32 data\n"),
    ("std_msgs/Float64MultiArray", "std_msgs/MultiArrayLayout layout\nfloat64[] data\n"),
    ("geometry_msgs/PoseStamped", POSE_STAMPED),
    ("geometry_msgs/PointStamped", "std_msgs/Header header\ngeometry_msgs/Point point\n"),
    (
        "geometry_msgs/PoseWithCovarianceStamped",
        "std_msgs/Header header\ngeometry_msgs/PoseWithCovariance pose\n",
    ),
    (
        "nav_msgs/Odometry",
        "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/PoseWithCovariance pose\n\
         geometry_msgs/TwistWithCovariance twist\n",
    ),
    ("nav_msgs/Path", "std_msgs/Header header\ngeometry_msgs/PoseStamped[] poses\n"),
];
const POSE_STAMPED: &str = "std_msgs/Header header\ngeometry_msgs/Pose pose\n";
const USED: [(&str, &str); 7] = [
    ("std_msgs/MultiArrayLayout", "std_msgs/MultiArrayDimension[] dim\nuint32 data_offset\n"),
    ("std_msgs/MultiArrayDimension", "string label\nuint32 size\nuint32 stride\n"),
    ("geometry_msgs/PoseStamped", POSE_STAMPED),
    ("geometry_msgs/PoseWithCovariance", "geometry_msgs/Pose pose\nfloat64[36] covariance\n"),
    ("geometry_msgs/TwistWithCovariance", "geometry_msgs/Twist twist\nfloat64[36] covariance\n"),
    ("geometry_msgs/Pose", "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n"),
    ("geometry_msgs/Point", "float64 x\nfloat64 y\nfloat64 z\n"),
];

/// The definition of a type that fits a message; empty if none does.
pub(super) fn definition(type_name: &str, message: &[u8]) -> String {
    let plain = plain_name(type_name);
    let known = if plain == CONTROLLER_STATE {
        controller_states()
    } else if let Some((_, text)) = OTHERS.iter().find(|(name, _)| *name == plain) {
        vec![described(&plain, text)]
    } else {
        vec![ros2msg(&plain)]
    };
    known.into_iter().find(|text| fits(type_name, text, message)).unwrap_or_default()
}

/// One of the others with the types that it may use.
fn described(root: &str, text: &str) -> String {
    let used = USED.iter().filter(|(name, _)| *name != root);
    let used: Vec<String> = used.map(|(name, text)| format!("===\nMSG: {name}\n{text}")).collect();
    format!("{text}{}===\n{}", used.concat(), used_by_states())
}

/// The types that the state of a controller uses: headers, speeds and quaternions, too.
fn used_by_states() -> String {
    let own = ros2msg(CONTROLLER_STATE);
    // They follow a line of `=`.
    own.find("\nMSG:").map_or_else(String::new, |at| own[at + 1..].to_owned())
}

fn controller_states() -> Vec<String> {
    let used = used_by_states();
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
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_known_definition_can_be_read() {
        let all = controller_states().into_iter().map(|text| (CONTROLLER_STATE, text));
        let others = OTHERS.map(|(name, text)| (name, described(name, text)));
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
        // Stamp, frame, place and orientation.
        let pose =
            [vec![0, 1, 0, 0], [[0; 4], [0; 4], 2_u32.to_le_bytes(), *b"b\0\0\0"].concat(), vec![0; 7 * 8]];
        assert!(definition("geometry_msgs/msg/PoseStamped", &pose.concat()).starts_with(POSE_STAMPED));
        assert_eq!(definition("nav_msgs/msg/Odometry", &pose.concat()), "");
    }
}
