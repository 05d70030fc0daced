//! The message definitions that a log carries, so that it can be read without ROS.

/// Between the definitions of one text, as rosbag2 writes them.
const DELIMITER: &str = "================================================================================";

macro_rules! definitions {
    ($($package:literal $name:literal,)*) => {
        /// `package/Name` and the definition of that type.
        const DEFINITIONS: &[(&str, &str)] = &[$((
            concat!($package, "/", $name),
            include_str!(concat!("../../../schemas/ros2/", $package, "/msg/", $name, ".msg")),
        ),)*];
    };
}

definitions! {
    "builtin_interfaces" "Duration",
    "builtin_interfaces" "Time",
    "control_msgs" "DynamicJointState",
    "control_msgs" "InterfaceValue",
    "control_msgs" "JointTrajectoryControllerState",
    "geometry_msgs" "Quaternion",
    "geometry_msgs" "Transform",
    "geometry_msgs" "TransformStamped",
    "geometry_msgs" "Twist",
    "geometry_msgs" "Vector3",
    "sensor_msgs" "JointState",
    "std_msgs" "Header",
    "std_msgs" "String",
    "tf2_msgs" "TFMessage",
    "trajectory_msgs" "JointTrajectory",
    "trajectory_msgs" "JointTrajectoryPoint",
    "trajectory_msgs" "MultiDOFJointTrajectoryPoint",
}

/// The `ros2msg` text of a type, `package/Name`, followed by those of all types it uses, each
/// once, in the order of their first use. Empty if the type is not among ours.
pub(in crate::log) fn ros2msg(root: &str) -> String {
    let mut types = vec![root];
    let mut text = String::new();
    let mut done = 0;
    while let Some(&name) = types.get(done) {
        let definition = own(name);
        if done > 0 {
            text.extend([DELIMITER, "\nMSG: ", name, "\n"]);
        }
        text.push_str(definition);
        for used in used_types(definition) {
            if !types.contains(&used) {
                types.push(used);
            }
        }
        done += 1;
    }
    text
}

fn own(name: &str) -> &'static str {
    DEFINITIONS.iter().find(|(known, _)| *known == name).map_or("", |(_, text)| text)
}

/// Types of other definitions; those are the ones with a slash, for ours are always qualified.
fn used_types(definition: &'static str) -> impl Iterator<Item = &'static str> {
    definition
        .lines()
        .filter(|line| !line.starts_with('#'))
        .filter_map(|line| line.split([' ', '[']).next())
        .filter(|used| used.contains('/'))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_type_in_use_is_defined_and_every_definition_is_qualified() {
        const PRIMITIVE: [&str; 4] = ["float64", "int32", "string", "uint32"];
        for (name, definition) in DEFINITIONS {
            assert!(definition.ends_with('\n'), "{name}");
            for line in definition.lines().filter(|line| !line.starts_with('#')) {
                let used = line.split([' ', '[']).next().unwrap();
                assert!(PRIMITIVE.contains(&used) || !own(used).is_empty(), "{name}: {line}");
            }
        }
    }

    #[test]
    fn a_text_holds_the_root_first_and_each_used_type_once() {
        let text = ros2msg("control_msgs/JointTrajectoryControllerState");
        let names: Vec<&str> = text.lines().filter_map(|line| line.strip_prefix("MSG: ")).collect();
        assert_eq!(
            names,
            [
                "std_msgs/Header",
                "trajectory_msgs/JointTrajectoryPoint",
                "trajectory_msgs/MultiDOFJointTrajectoryPoint",
                "builtin_interfaces/Time",
                "builtin_interfaces/Duration",
                "geometry_msgs/Transform",
                "geometry_msgs/Twist",
                "geometry_msgs/Vector3",
                "geometry_msgs/Quaternion",
            ]
        );
        assert_eq!(DELIMITER, "=".repeat(80));
        assert_eq!(text.matches(DELIMITER).count(), names.len());
    }
}
