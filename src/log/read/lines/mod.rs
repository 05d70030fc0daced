//! Where the numbers of joints lie in the messages of a log, for programs that draw them from the log itself.

mod described;
mod roles;

use super::{
    content::{Content, Extracted},
    description,
    recording::Recording,
};
use crate::log::{
    LogError,
    decode::shape_at,
    options::{ReadOptions, Selector, SignalRole, WantedSignal},
    schema::{Shape, plain_name},
    source::{Form, Table},
    write::{SUPPLY, Topics, VALVE},
};
use described::Described;
pub(super) use described::Descriptions;
use roles::Roles;

/// What a line shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[expect(missing_docs, reason = "the names say it")]
pub enum LineRole {
    Planned,
    Measured,
    Command,
    Error,
    PlannedSpeed,
    MeasuredSpeed,
    Valve,
    CapPressure,
    RodPressure,
    SupplyPressure,
    Effort,
}

/// A step from a message towards a number in it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Step {
    /// Into a field.
    Field(String),
    /// To an element of a list.
    Place(usize),
    /// To the element of a list whose field `name` says so, at the same place in every message if there is one.
    Named {
        /// The name.
        name: String,
        /// Its place.
        place: Option<usize>,
    },
}

/// A number of a joint, message by message.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Line {
    /// What it is.
    pub role: LineRole,
    /// The joint, as the log calls it.
    pub joint: String,
    /// Index of the topic.
    pub topic: usize,
    /// From the message to the number.
    pub path: Vec<Step>,
    /// How many joints a message has.
    pub places: usize,
}

/// A topic as its channel describes it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DrawnTopic {
    /// Its name.
    pub topic: String,
    /// Message type, as the log spells it.
    pub type_name: String,
    /// Message encoding.
    pub encoding: String,
    /// Encoding of its schema.
    pub schema_encoding: String,
    /// Whether its messages begin with a header, whose stamp other programs use.
    pub stamped: bool,
}

/// All that can be drawn of a log from its own messages.
#[derive(Debug)]
pub struct Lines {
    /// Names of the files, without paths.
    pub files: Vec<String>,
    /// Topics of the lines.
    pub topics: Vec<DrawnTopic>,
    /// By role, joint by joint.
    pub lines: Vec<Line>,
    /// Topics with the robot's description.
    pub descriptions: Vec<String>,
    /// Whether frames of it are placed.
    pub transforms: bool,
    /// When the first message was recorded, ns since 1970.
    pub begins_ns: u64,
    /// Topics that hold the plan as whole trajectories, which is no line.
    pub trajectories: Vec<String>,
    /// Topics whose joints change places from message to message.
    pub unsteady: Vec<String>,
    /// Plan and measurement, if a report can be made of them.
    pub recording: Result<Recording, LogError>,
}

/// Interfaces of our own logs and of `ros2_control`.
const INTERFACES: [(LineRole, &str); 5] = [
    (LineRole::Valve, VALVE),
    (LineRole::CapPressure, "cap_pressure_pa"),
    (LineRole::RodPressure, "rod_pressure_pa"),
    (LineRole::SupplyPressure, SUPPLY),
    (LineRole::Effort, "effort"),
];

/// The options with every field that may be a line.
pub(super) fn wanting_all(options: &ReadOptions, known: &Descriptions) -> ReadOptions {
    let mut options = ReadOptions { measured_velocities: true, ..options.clone() };
    for (topic, type_name) in known.names() {
        let fields: Vec<&str> = match plain_name(&type_name.replace('.', "/")).as_str() {
            "sensor_msgs/JointState" => vec!["effort"],
            "foxglove/JointStates" | "foxglove_msgs/JointStates" => vec!["joints.effort"],
            "control_msgs/JointTrajectoryControllerState" => vec!["error.positions"],
            "control_msgs/DynamicJointState" => INTERFACES.iter().map(|(_, name)| *name).collect(),
            _ => Vec::new(),
        };
        // The role says nothing here: what it is read as is decided by topic and field.
        let wanted = |field: &str| WantedSignal {
            role: SignalRole::Effort,
            topic: Some(Selector { topic: topic.to_owned(), field: Some(field.to_owned()) }),
        };
        options.signals.extend(fields.into_iter().map(wanted));
    }
    options
}

/// The lines of what was read; `recording` is made of the same afterwards.
pub(super) fn of(
    extracted: &Extracted,
    known: &Descriptions,
    options: &ReadOptions,
) -> Result<Lines, LogError> {
    let roles = Roles::of(extracted, options)?;
    let times = || extracted.topics.iter().filter(|topic| topic.messages > 0);
    let mut lines = Lines {
        files: extracted.files.iter().map(|file| file.name.clone()).collect(),
        topics: Vec::new(),
        lines: Vec::new(),
        descriptions: Vec::new(),
        transforms: false,
        begins_ns: times().map(|topic| topic.first_log_ns).min().unwrap_or(0),
        trajectories: roles.trajectories(extracted),
        unsteady: Vec::new(),
        recording: Err(LogError::NotLookedAt { logs: String::new() }),
    };
    for topic in times() {
        match plain_name(&topic.type_name.replace('.', "/")).as_str() {
            "std_msgs/String" if description::is_topic(&topic.topic) => {
                lines.descriptions.push(topic.topic.clone());
            }
            "tf2_msgs/TFMessage" | "tf/tfMessage" | "foxglove/FrameTransforms" => lines.transforms = true,
            _ => {}
        }
    }
    lines.descriptions.sort();
    for (index, source) in extracted.sources.iter().enumerate() {
        let Content::Table(table) = &source.content else { continue };
        if !matches!(table.form, Form::Table | Form::Groups | Form::Interfaces) {
            continue;
        }
        let fields: Vec<(usize, LineRole)> = (0..table.fields.len())
            .filter_map(|field| Some((field, roles.of_field(extracted, index, field)?)))
            .collect();
        let count = extracted.topic_of(index);
        let described = known.get(&count.topic, &count.type_name);
        lines.add(
            table,
            &fields,
            described,
            |joint| roles.wants(joint),
            || DrawnTopic {
                topic: count.topic.clone(),
                type_name: count.type_name.clone(),
                encoding: count.encoding.clone(),
                schema_encoding: described.schema_encoding.clone(),
                stamped: described.has("header.stamp"),
            },
        );
    }
    // The first topic that has a number of a joint is drawn.
    lines.lines.sort_by_key(|line| (line.role, roles.place(&line.joint)));
    lines.lines.dedup_by(|next, first| (next.role, &next.joint) == (first.role, &first.joint));
    if lines.lines.is_empty() {
        return Err(roles.nothing(extracted));
    }
    Ok(lines)
}

impl Lines {
    fn add(
        &mut self,
        table: &Table,
        fields: &[(usize, LineRole)],
        described: &Described,
        wants: impl Fn(&str) -> bool,
        topic: impl Fn() -> DrawnTopic,
    ) {
        let mut new = Vec::new();
        let joints = table.joint_places();
        for &(field, role) in fields {
            for (joint, name) in table.joints.iter().enumerate() {
                if !wants(name) || !table.column(field, joint).iter().any(|value| value.is_finite()) {
                    continue;
                }
                let place = joints.as_ref().and_then(|joints| joints.iter().position(|one| one == name));
                let path = path(table, field, name, place, described);
                let places = joints.as_ref().map_or(0, Vec::len);
                match path {
                    Some(path) => {
                        new.push(Line { role, joint: name.clone(), topic: self.topics.len(), path, places });
                    }
                    None if self.unsteady.contains(&topic().topic) => {}
                    None => self.unsteady.push(topic().topic),
                }
            }
        }
        if !new.is_empty() {
            self.topics.push(topic());
            self.lines.extend(new);
        }
    }
}

/// The way to a number; `None` if it changes.
fn path(
    table: &Table,
    field: usize,
    joint: &str,
    place: Option<usize>,
    described: &Described,
) -> Option<Vec<Step>> {
    let at = &table.fields.get(field)?.path;
    let into = |names: &str| names.split('.').map(|name| Step::Field(name.to_owned())).collect::<Vec<_>>();
    match table.form {
        Form::Groups => {
            let (list, leaf) = at.split_once('.')?;
            let named = Step::Named { name: joint.to_owned(), place };
            Some(into(list).into_iter().chain([named]).chain(into(leaf)).collect())
        }
        Form::Interfaces => {
            let place = place?;
            let value = Step::Place(table.interface_place(place, field)?);
            let list = into("interface_values").into_iter().chain([Step::Place(place)]);
            Some(list.chain(into("values")).chain([value]).collect())
        }
        Form::Table => {
            let place = place?;
            let single = described
                .definition
                .as_ref()
                .and_then(|definition| shape_at(definition, at))
                .is_some_and(|shape| matches!(shape, Shape::Number(_)));
            let place = (!single).then_some(Step::Place(place));
            Some(into(at).into_iter().chain(place).collect())
        }
        _ => None,
    }
}

/// Where our own logs have a signal that has a topic of its own.
fn own(role: LineRole) -> Option<String> {
    match role {
        LineRole::Command => Some(Topics::default().command),
        LineRole::Error => Some(Topics::default().tracking_error),
        _ => None,
    }
}
