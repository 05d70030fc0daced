//! Message definitions as recorders store them, both notations.

const DEFINITIONS: &[(&str, &str)] = &[
    ("builtin_interfaces/Time", "int32 sec\nuint32 nanosec\n"),
    ("builtin_interfaces/Duration", "int32 sec\nuint32 nanosec\n"),
    ("std_msgs/Header", "builtin_interfaces/Time stamp\nstring frame_id\n"),
    (
        "sensor_msgs/JointState",
        "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n",
    ),
    (
        "trajectory_msgs/JointTrajectoryPoint",
        "float64[] positions\nfloat64[] velocities\nfloat64[] accelerations\nfloat64[] effort\nbuiltin_interfaces/Duration time_from_start\n",
    ),
    (
        "trajectory_msgs/JointTrajectory",
        "std_msgs/Header header\nstring[] joint_names\nJointTrajectoryPoint[] points\n",
    ),
    ("geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z\n"),
    ("geometry_msgs/Quaternion", "float64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1\n"),
    ("geometry_msgs/Transform", "Vector3 translation\nQuaternion rotation\n"),
    ("geometry_msgs/Twist", "Vector3 linear\nVector3 angular\n"),
    ("geometry_msgs/Wrench", "Vector3 force\nVector3 torque\n"),
    (
        "trajectory_msgs/MultiDOFJointTrajectoryPoint",
        "geometry_msgs/Transform[] transforms\ngeometry_msgs/Twist[] velocities\ngeometry_msgs/Twist[] accelerations\nbuiltin_interfaces/Duration time_from_start\n",
    ),
    (
        "trajectory_msgs/MultiDOFJointTrajectory",
        "std_msgs/Header header\nstring[] joint_names\nMultiDOFJointTrajectoryPoint[] points\n",
    ),
    (
        "sensor_msgs/MultiDOFJointState",
        "std_msgs/Header header\nstring[] joint_names\ngeometry_msgs/Transform[] transforms\ngeometry_msgs/Twist[] twist\ngeometry_msgs/Wrench[] wrench\n",
    ),
    (
        "moveit_msgs/RobotTrajectory",
        "trajectory_msgs/JointTrajectory joint_trajectory\ntrajectory_msgs/MultiDOFJointTrajectory multi_dof_joint_trajectory\n",
    ),
    (
        "moveit_msgs/RobotState",
        "sensor_msgs/JointState joint_state\nsensor_msgs/MultiDOFJointState multi_dof_joint_state\nbool is_diff\n",
    ),
    (
        "moveit_msgs/DisplayTrajectory",
        "# The model id\nstring model_id\n\nRobotTrajectory[] trajectory\n\nRobotState trajectory_start\n",
    ),
    ("control_msgs/InterfaceValue", "string[] interface_names\nfloat64[] values\n"),
    (
        "control_msgs/DynamicJointState",
        "std_msgs/Header header\nstring[] joint_names\nInterfaceValue[] interface_values\n",
    ),
    ("pal_statistics_msgs/StatisticsNames", "std_msgs/Header header\nstring[] names\nuint32 names_version\n"),
    (
        "pal_statistics_msgs/StatisticsValues",
        "std_msgs/Header header\nfloat64[] values\nuint32 names_version\n",
    ),
    ("std_msgs/MultiArrayDimension", "string label\nuint32 size\nuint32 stride\n"),
    ("std_msgs/MultiArrayLayout", "MultiArrayDimension[] dim\nuint32 data_offset\n"),
    ("std_msgs/Float64MultiArray", "MultiArrayLayout  layout\nfloat64[] data\n"),
    (
        "foxglove_msgs/JointState",
        "string name\nfloat64 position\nfloat64 velocity\nfloat64 acceleration\nfloat64 effort\n",
    ),
    ("foxglove_msgs/JointStates", "builtin_interfaces/Time timestamp\nJointState[] joints\n"),
];

/// The text of a type with all it uses, as rosbag2 stores it.
pub(crate) fn text(type_name: &str) -> String {
    let root = type_name.replace("/msg/", "/");
    let own = DEFINITIONS.iter().find(|(name, _)| *name == root).map_or("", |(_, text)| *text);
    text_of(&root, own)
}

/// The same for a root text of the test's own.
pub(crate) fn text_of(root: &str, own: &str) -> String {
    let mut text = own.to_owned();
    let mut types: Vec<(String, String)> = vec![(root.to_owned(), own.to_owned())];
    let mut done = 0;
    while let Some((name, body)) = types.get(done).cloned() {
        if done > 0 {
            text += &format!("{}\nMSG: {name}\n{body}", "=".repeat(80) + "");
        }
        let package = name.split('/').next().unwrap();
        for word in body.lines().filter_map(|line| line.split(['[', ' ']).next()) {
            let full = if word.contains('/') { word.to_owned() } else { format!("{package}/{word}") };
            if let Some((_, body)) = DEFINITIONS.iter().find(|(name, _)| *name == full)
                && types.iter().all(|(known, _)| *known != full)
            {
                types.push((full, (*body).to_owned()));
            }
        }
        done += 1;
    }
    text
}

/// Fields of the state of a joint trajectory controller between its names and what follows them.
pub(crate) fn controller_state(points: &[&str], multi_dof: bool, speed_scaling: bool) -> String {
    let mut own = "std_msgs/Header header\nstring[] joint_names\n".to_owned();
    for point in points {
        own += &format!("trajectory_msgs/JointTrajectoryPoint {point}\n");
    }
    if multi_dof {
        own += "string[] multi_dof_joint_names\n";
        for point in points {
            own += &format!("trajectory_msgs/MultiDOFJointTrajectoryPoint multi_dof_{point}\n");
        }
    }
    if speed_scaling {
        own += "# The current speed scaling\nfloat64 speed_scaling_factor\n";
    }
    text_of("control_msgs/JointTrajectoryControllerState", &own)
}

/// `sensor_msgs/msg/JointState` as rosbag2 stores it where only IDL is installed.
pub(crate) fn joint_state_idl() -> String {
    let rule = "=".repeat(80);
    format!(
        "{rule}\nIDL: sensor_msgs/msg/JointState\n// generated from rosidl_adapter/resource/msg.idl.em\n\
         // with input from sensor_msgs/msg/JointState.msg\n// generated code does not contain a copyright notice\n\n\
         #include \"std_msgs/msg/Header.idl\"\n\nmodule sensor_msgs {{\n  module msg {{\n    \
         @verbatim (language=\"comment\", text=\n      \"state of a joint; {{it}} (is) \\\"this\\\":\" \"\\n\"\n      \"more\")\n    \
         struct JointState {{\n      std_msgs::msg::Header header;\n\n      sequence<string> name;\n\n      \
         @unit (value=\"rad\")\n      sequence<double> position;\n\n      sequence<double> velocity;\n\n      \
         sequence<double> effort;\n    }};\n  }};\n}};\n\n\
         {rule}\nIDL: std_msgs/msg/Header\n#include \"builtin_interfaces/msg/Time.idl\"\nmodule std_msgs {{\n  module msg {{\n    \
         struct Header {{\n      builtin_interfaces::msg::Time stamp;\n      string frame_id;\n    }};\n  }};\n}};\n\n\
         {rule}\nIDL: builtin_interfaces/msg/Time\nmodule builtin_interfaces {{\n  module msg {{\n    \
         struct Time {{\n      int32 sec;\n      uint32 nanosec;\n    }};\n  }};\n}};\n"
    )
}
