//! How a log is written.

/// How a log is written. The default suits a log that is written in one go; see
/// [`Options::live`].
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Options {
    /// Uncompressed size at which a chunk is closed, bytes; at most 64 MiB.
    pub chunk_bytes: u32,
    /// Span of stamps after which everything is handed to the operating system, ns; `None`
    /// leaves it to [`flush`](super::LogWriter::flush). Every flush closes a chunk, so a short
    /// interval compresses worse.
    pub flush_interval_ns: Option<u64>,
    /// Compression level of zstd, 1 to 22.
    pub compression_level: u32,
    /// How much later than its stamp a message counts as received, ns.
    pub log_delay_ns: i64,
    /// Where messages go.
    pub topics: Topics,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            chunk_bytes: 1 << 20,
            flush_interval_ns: None,
            // Joint angles compress no better at the usual level 3, which takes half as long again.
            compression_level: 1,
            log_delay_ns: 0,
            topics: Topics::default(),
        }
    }
}

impl Options {
    /// Chunks are built in memory, so they have a limit.
    pub(super) const MAX_CHUNK_BYTES: u32 = 1 << 26;

    /// For recording while a machine moves: at most one second is lost with the process.
    pub fn live() -> Self {
        Self { flush_interval_ns: Some(1_000_000_000), ..Self::default() }
    }
}

/// Name of what is sent to the valves, among the interfaces of our own logs and of `ros2_control`.
pub(in crate::log) const VALVE: &str = "valve_command";

/// That which holds the pressure before the valves, Pa.
pub(in crate::log) const SUPPLY: &str = "supply_pressure_pa";

/// Names of topics, all different. A topic appears in the log with its first message.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Topics {
    /// `sensor_msgs/msg/JointState` of [`Role::Planned`].
    pub planned: String,
    /// `sensor_msgs/msg/JointState` of [`Role::Measured`].
    pub measured: String,
    /// `sensor_msgs/msg/JointState` of [`Role::Command`].
    pub command: String,
    /// `control_msgs/msg/JointTrajectoryControllerState`.
    pub controller_state: String,
    /// `trajectory_msgs/msg/JointTrajectory`.
    pub trajectory: String,
    /// `control_msgs/msg/DynamicJointState`.
    pub interfaces: String,
    /// `std_msgs/msg/String`: a URDF.
    pub description: String,
    /// `std_msgs/msg/String`: the URDF of the arm as planned, beside that of the arm as measured.
    pub planned_description: String,
    /// `tf2_msgs/msg/TFMessage` of links that move.
    pub transforms: String,
    /// `tf2_msgs/msg/TFMessage` of links that do not move.
    pub fixed_transforms: String,
    /// `sensor_msgs/msg/JointState`: plan minus measurement.
    pub tracking_error: String,
}

impl Default for Topics {
    fn default() -> Self {
        Self {
            planned: "/planned/joint_states".into(),
            measured: "/joint_states".into(),
            command: "/command/joint_states".into(),
            controller_state: "/arm_controller/controller_state".into(),
            trajectory: "/arm_controller/joint_trajectory".into(),
            interfaces: "/dynamic_joint_states".into(),
            description: "/robot_description".into(),
            planned_description: "/planned/robot_description".into(),
            transforms: "/tf".into(),
            fixed_transforms: "/tf_static".into(),
            tracking_error: "/tracking_error".into(),
        }
    }
}

/// Role of a joint sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Role {
    /// Where the plan wants the joints.
    Planned,
    /// Where the sensors say they are.
    Measured,
    /// The positions sent to the machine, where they differ from the plan.
    Command,
}
