//! Definitions for files that name a type without describing it.
//!
//! rosbag2 up to jazzy stores action feedback with an empty schema, up to Humble no schema of any type in SQLite; and
//! some writers leave out the basic types. Only fields that every version has are listed; messages may go on after.

use super::{Definition, Number, Shape, Struct, resolve, ros2msg};

const FEEDBACK: &str = include_str!("builtin/follow_joint_trajectory_feedback.txt");
const ROBOT: &str = include_str!("builtin/robot_trajectory.txt");
/// What it shows from is behind what is read.
const DISPLAY: &str =
    concat!(include_str!("builtin/display_trajectory.txt"), include_str!("builtin/robot_trajectory.txt"));

/// The definition of a type that files leave undescribed.
pub(in crate::log) fn builtin(name: &str) -> Option<Definition> {
    let text = match name {
        "control_msgs/action/FollowJointTrajectory_FeedbackMessage" => FEEDBACK,
        "moveit_msgs/msg/RobotTrajectory" => ROBOT,
        "moveit_msgs/msg/DisplayTrajectory" => DISPLAY,
        _ => return None,
    };
    let structs = ros2msg::parse(name, text).ok()?;
    let definition = resolve(&super::plain_name(name), structs).ok()?;
    Some(Definition { open_ended: true, ..definition })
}

/// Types so basic that texts may leave them out.
pub(super) fn basics() -> [Struct<String>; 5] {
    let stamp = |name: &str| Struct {
        name: name.to_owned(),
        fields: vec![
            ("sec".to_owned(), Shape::Number(Number::I32)),
            ("nanosec".to_owned(), Shape::Number(Number::U32)),
        ],
    };
    let header = Struct {
        name: "std_msgs/Header".to_owned(),
        fields: vec![
            ("stamp".to_owned(), Shape::Struct("builtin_interfaces/Time".to_owned())),
            ("frame_id".to_owned(), Shape::Text),
        ],
    };
    [
        stamp("builtin_interfaces/Time"),
        stamp("builtin_interfaces/Duration"),
        header,
        stamp("time"),
        stamp("duration"),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn definitions_parse_and_start_with_what_is_read() {
        for (name, fields) in [
            ("control_msgs/action/FollowJointTrajectory_FeedbackMessage", ["goal_id", "feedback"]),
            ("moveit_msgs/msg/RobotTrajectory", ["joint_trajectory", "multi_dof_joint_trajectory"]),
            ("moveit_msgs/msg/DisplayTrajectory", ["model_id", "trajectory"]),
        ] {
            let definition = builtin(name).unwrap();
            let names: Vec<&str> =
                definition.structs[0].fields.iter().map(|(name, _)| name.as_str()).collect();
            assert_eq!(names, fields);
            assert!(definition.open_ended);
        }
    }
}
