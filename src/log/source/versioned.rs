//! Values whose names come in another topic, joined by a version number
//! (`pal_statistics_msgs`, as the ROS 2 controller manager publishes its interfaces).

use std::collections::{BTreeMap, BTreeSet};

use super::{Field, Form, Role, Stamps, Table, slot, table::stamp_ns};
use crate::log::{
    csv::{Quantity, joint_in, of_joint},
    decode::{Numbers, Sink, Slot, Texts},
    options::TimeBase,
    write,
};

/// Either half: the lists of names by version, or the values.
#[derive(Debug, Clone, Default, PartialEq)]
pub(in crate::log) struct Versioned {
    names: BTreeMap<u64, Vec<String>>,
    stamps: Stamps,
    versions: Vec<u64>,
    values: Vec<Vec<f64>>,
    message: Message,
}

#[derive(Debug, Clone, Default, PartialEq)]
struct Message {
    second: f64,
    nanosecond: f64,
    version: f64,
    names: Vec<String>,
    values: Vec<f64>,
}

impl Versioned {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a float to integer cast saturates"
    )]
    pub(in crate::log) fn commit(&mut self, publish_ns: u64, log_ns: u64) {
        let message = std::mem::take(&mut self.message);
        let version = message.version as u64;
        if !message.names.is_empty() {
            self.names.insert(version, message.names);
        }
        if !message.values.is_empty() {
            self.stamps.push(stamp_ns(message.second, message.nanosecond), publish_ns, log_ns);
            self.versions.push(version);
            self.values.push(message.values);
        }
    }

    pub(in crate::log) fn append(&mut self, other: &mut Self) {
        self.names.append(&mut other.names);
        self.stamps.append(&other.stamps, 0);
        other.stamps.clear();
        self.versions.append(&mut other.versions);
        self.values.append(&mut other.values);
    }

    pub(in crate::log) fn has_names(&self) -> bool {
        !self.names.is_empty()
    }

    /// All names that there are.
    pub(in crate::log) fn names(&self) -> impl Iterator<Item = &String> {
        self.names.values().flatten()
    }

    /// The values as samples of joints, and whether only words tell them: `command_interface.<joint>/position` is the plan,
    /// `state_interface.<joint>/position` the measurement; without such names what the words say as of headers of columns.
    /// Each of those that are `asked` for is a field of its own. `None` without any.
    pub(in crate::log) fn to_table(&self, halves: &[&Self], asked: &BTreeSet<&str>) -> Option<(Table, bool)> {
        let field = |path: &str, role, velocity, is_velocity| Field {
            path: path.into(),
            role,
            velocity,
            is_velocity,
        };
        let known = [
            field("command.position", Role::Planned, Some(1), false),
            field("command.velocity", Role::Planned, None, true),
            field("state.position", Role::Measured, None, false),
        ];
        let own = asked.iter().map(|name| field(name, Role::Either, None, false));
        let fields: Vec<Field> = known.iter().cloned().chain(own).collect();
        let all = || halves.iter().flat_map(|half| half.names());
        let by_words = !all().any(|name| interface(name).is_some());
        let of = if by_words { spelt } else { interface };
        let told = by_words && all().any(|name| spelt(name).is_some());
        let mut table = Table::new(Form::Versioned, &fields, &[], None);
        let mut places: BTreeMap<u64, Vec<(usize, String, usize)>> = BTreeMap::new();
        for (version, names) in halves.iter().flat_map(|half| &half.names) {
            let of_name = |(place, name): (usize, &String)| {
                let own = asked.iter().position(|asked| *asked == name.as_str());
                let own = own.map(|at| (joint_of(name), known.len() + at));
                own.into_iter()
                    .chain(of(name))
                    .map(move |(joint, field)| (place, joint, field))
                    .collect::<Vec<_>>()
            };
            places.insert(*version, names.iter().enumerate().flat_map(of_name).collect());
        }
        for (row, (version, values)) in self.versions.iter().zip(&self.values).enumerate() {
            let Some(places) = places.get(version) else { continue };
            let (header, publish, log) =
                (self.stamps.header_ns[row], self.stamps.of(TimeBase::Publish)[row], self.stamps.log_ns[row]);
            let cells = places.iter().filter_map(|(place, joint, field)| {
                values.get(*place).map(|&value| (joint.as_str(), *field, value))
            });
            table.push_row(header, publish, log, cells);
        }
        (!table.joints.is_empty()).then_some((table, told))
    }
}

/// The joint and the field of an interface.
fn interface(name: &str) -> Option<(String, usize)> {
    let (kind, rest) = name.split_once(['.', '/'])?;
    let (joint, quantity) = rest.rsplit_once('/')?;
    let field = match (kind, quantity) {
        ("command_interface", "position") => 0,
        ("command_interface", "velocity") => 1,
        ("state_interface", "position") => 2,
        _ => return None,
    };
    Some((joint.to_owned(), field))
}

/// The joint of a value that was asked for, in whatever kind and quantity of interface: `out.boom/angle`.
fn joint_of(name: &str) -> String {
    let within = name.split_once(['.', '/']).filter(|(kind, _)| !kind.is_empty());
    let joint = within.and_then(|(_, rest)| rest.rsplit_once('/')).map(|(joint, _)| joint.to_owned());
    joint.unwrap_or_else(|| joint_in(name))
}

/// The joint and the field that the words of a name say: `/arm_desired_position_boom_joint`.
fn spelt(name: &str) -> Option<(String, usize)> {
    let said = of_joint(name).filter(|said| said.alone)?;
    let field = match (said.role?, said.quantity?) {
        (write::Role::Planned, Quantity::Position) => 0,
        (write::Role::Planned, Quantity::Velocity) => 1,
        (write::Role::Measured, Quantity::Position) => 2,
        _ => return None,
    };
    Some((joint_in(name), field))
}

impl Sink for Versioned {
    fn number(&mut self, slot: Slot, value: f64) {
        match slot {
            slot::SECOND => self.message.second = value,
            slot::NANOSECOND => self.message.nanosecond = value,
            slot::VERSION => self.message.version = value,
            _ => {}
        }
    }

    fn numbers(&mut self, slot: Slot, values: Numbers<'_>) {
        if slot == slot::VALUES {
            self.message.values = values.to_vec();
        }
    }

    fn texts(&mut self, slot: Slot, values: Texts<'_>) {
        if slot == slot::NAMES {
            self.message.names = values.to_vec();
        }
    }

    fn element(&mut self, slot: Slot) {
        if slot == Slot::MAX {
            self.message = Message::default();
        }
    }
}
