//! One topic of a log being written.

use std::{collections::BTreeMap, io::Write};

use mcap::{
    McapResult,
    records::MessageHeader,
    write::{NoSeek, Writer},
};

use super::{definition, stamp::Stamp};

/// Quality of service that replaying tools offer again: keep the last ten, reliable, volatile,
/// no deadlines. Integers and not names, because ROS 2 before jazzy knows only these.
const OFFERED_QOS_PROFILES: &str = "\
- history: 1
  depth: 10
  reliability: 1
  durability: 2
  deadline: {sec: 9223372036, nsec: 854775807}
  lifespan: {sec: 9223372036, nsec: 854775807}
  liveliness: 1
  liveliness_lease_duration: {sec: 9223372036, nsec: 854775807}
  avoid_ros_namespace_conventions: false
";

/// The same for messages sent once: the last one is kept for late subscribers.
const LATCHED_QOS_PROFILES: &str = "\
- history: 1
  depth: 1
  reliability: 1
  durability: 1
  deadline: {sec: 9223372036, nsec: 854775807}
  lifespan: {sec: 9223372036, nsec: 854775807}
  liveliness: 1
  liveliness_lease_duration: {sec: 9223372036, nsec: 854775807}
  avoid_ros_namespace_conventions: false
";

/// A message type and the hash of its definition by REP 2016.
#[derive(Debug)]
pub(super) struct MessageType {
    package: &'static str,
    name: &'static str,
    hash: &'static str,
}

const fn message(package: &'static str, name: &'static str, hash: &'static str) -> MessageType {
    MessageType { package, name, hash }
}

pub(super) const JOINT_STATE: MessageType = message(
    "sensor_msgs",
    "JointState",
    "RIHS01_a13ee3a330e346c9d87b5aa18d24e11690752bd33a0350f11c5882bc9179260e",
);
pub(super) const JOINT_TRAJECTORY: MessageType = message(
    "trajectory_msgs",
    "JointTrajectory",
    "RIHS01_179b33eba59d676f6d967ac71fe35e7ca2f64b2f3928f4a018cec115e213796e",
);
pub(super) const CONTROLLER_STATE: MessageType = message(
    "control_msgs",
    "JointTrajectoryControllerState",
    "RIHS01_51d8dd89cc624cbe9daaeeb4d80d6de9b86168ffdc3be41fefc0953e3c26e480",
);
pub(super) const DYNAMIC_JOINT_STATE: MessageType = message(
    "control_msgs",
    "DynamicJointState",
    "RIHS01_18024c98a62697680f581108eeed40b28fb4542fa0ac5a8e36f56c62b6813d26",
);
pub(super) const TEXT: MessageType =
    message("std_msgs", "String", "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18");
pub(super) const TRANSFORMS: MessageType = message(
    "tf2_msgs",
    "TFMessage",
    "RIHS01_e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087",
);

/// A topic; the log learns of it with its first message.
#[derive(Debug)]
pub(super) struct Channel {
    topic: String,
    message_type: &'static MessageType,
    qos_profiles: &'static str,
    id: Option<u16>,
    sequence: u32,
}

impl Channel {
    pub(super) fn new(topic: String, message_type: &'static MessageType) -> Self {
        Self { topic, message_type, qos_profiles: OFFERED_QOS_PROFILES, id: None, sequence: 0 }
    }

    /// A topic whose last message is kept for late subscribers.
    pub(super) fn latched(topic: String, message_type: &'static MessageType) -> Self {
        Self { qos_profiles: LATCHED_QOS_PROFILES, ..Self::new(topic, message_type) }
    }

    pub(super) fn topic(&self) -> &str {
        &self.topic
    }

    pub(super) fn send<W: Write>(
        &mut self,
        log: &mut Writer<NoSeek<W>>,
        stamp: Stamp,
        data: &[u8],
    ) -> McapResult<()> {
        let channel_id = match self.id {
            Some(id) => id,
            None => *self.id.insert(self.register(log)?),
        };
        let header = MessageHeader {
            channel_id,
            sequence: self.sequence,
            log_time: stamp.log_time_ns,
            publish_time: stamp.log_time_ns,
        };
        self.sequence = self.sequence.wrapping_add(1);
        log.write_to_known_channel(&header, data)
    }

    fn register<W: Write>(&self, log: &mut Writer<NoSeek<W>>) -> McapResult<u16> {
        let MessageType { package, name, hash } = self.message_type;
        let text = definition::ros2msg(&format!("{package}/{name}"));
        let schema = log.add_schema(&format!("{package}/msg/{name}"), "ros2msg", text.as_bytes())?;
        let metadata = BTreeMap::from([
            ("offered_qos_profiles".to_owned(), self.qos_profiles.to_owned()),
            ("topic_type_hash".to_owned(), (*hash).to_owned()),
        ]);
        log.add_channel(schema, &self.topic, "cdr", &metadata)
    }
}
