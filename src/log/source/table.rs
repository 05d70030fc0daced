//! Samples of one topic, one column for each field and joint.

use std::collections::BTreeMap;

use super::{Field, Form, slot};
use crate::log::decode::{Numbers, Sink, Slot, Texts};

/// The three clocks of every message of a topic, in the order of the file.
#[derive(Debug, Clone, Default, PartialEq)]
pub(in crate::log) struct Stamps {
    /// From the message itself; 0 where it has none.
    pub(in crate::log) header_ns: Vec<i64>,
    pub(in crate::log) publish_ns: Vec<i64>,
    pub(in crate::log) log_ns: Vec<i64>,
}

impl Stamps {
    pub(in crate::log) fn len(&self) -> usize {
        self.log_ns.len()
    }

    pub(super) fn push_ns(&mut self, header_ns: i64, publish_ns: i64, log_ns: i64) {
        self.header_ns.push(header_ns);
        self.publish_ns.push(publish_ns);
        self.log_ns.push(log_ns);
    }

    pub(super) fn push(&mut self, header_ns: i64, publish_ns: u64, log_ns: u64) {
        let fit = |ns| i64::try_from(ns).unwrap_or(i64::MAX);
        self.push_ns(header_ns, fit(publish_ns), fit(log_ns));
    }

    pub(super) fn append(&mut self, other: &Self) {
        self.header_ns.extend_from_slice(&other.header_ns);
        self.publish_ns.extend_from_slice(&other.publish_ns);
        self.log_ns.extend_from_slice(&other.log_ns);
    }

    pub(super) fn clear(&mut self) {
        self.header_ns.clear();
        self.publish_ns.clear();
        self.log_ns.clear();
    }
}

/// Seconds and nanoseconds of a stamp in nanoseconds, 0 if it is no time.
#[expect(clippy::cast_possible_truncation, reason = "range checked")]
pub(super) fn stamp_ns(second: f64, nanosecond: f64) -> i64 {
    let fits = |value: f64| value.is_finite() && value.abs() < 9.0e9;
    if fits(second) && fits(nanosecond) { second as i64 * 1_000_000_000 + nanosecond as i64 } else { 0 }
}

/// Samples of one topic.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::log) struct Table {
    pub(in crate::log) form: Form,
    pub(in crate::log) fields: Vec<Field>,
    pub(in crate::log) stamps: Stamps,
    /// Joint names in the order of their first appearance.
    pub(in crate::log) joints: Vec<String>,
    /// `[field][joint][sample]`; NaN where a message lacks the joint or the number. A column is
    /// empty if no message had it, and ends with the last message that did.
    pub(in crate::log) columns: Vec<Vec<Vec<f64>>>,
    /// Speed scaling by sample; empty if the type has none.
    pub(in crate::log) speed_scaling: Vec<f64>,
    /// Numbers in the data that are NaN or infinite, by field.
    pub(in crate::log) not_finite: Vec<u64>,
    /// Messages whose array is not as long as the list of names, by field.
    pub(in crate::log) length_mismatch: Vec<u64>,
    /// Messages whose list of joints differs from the one before.
    pub(in crate::log) layout_changes: u64,
    message: Message,
    /// Names to use where messages carry none.
    default_joints: Vec<String>,
    /// Emptied columns, kept for their memory.
    spare: Vec<Vec<f64>>,
}

/// No arm has more; a topic that names more is not about joints.
const MAX_JOINTS: usize = 1024;

/// The message being read: nothing of it counts before it is complete.
#[derive(Debug, Clone, Default, PartialEq)]
struct Message {
    second: f64,
    nanosecond: f64,
    speed_scaling: f64,
    /// `[field][place]`.
    values: Vec<Vec<f64>>,
    /// Place in the message to joint.
    layout: Vec<usize>,
    /// Bytes or names that `layout` came from.
    layout_raw: Vec<u8>,
    layout_names: Vec<String>,
    group_names: Vec<String>,
    groups: usize,
    /// Place of each field among the values of the current group.
    interface_places: Vec<Option<usize>>,
}

impl Table {
    /// `joints` are the names to use where messages carry none.
    pub(in crate::log) fn new(form: Form, fields: &[Field], joints: &[String]) -> Self {
        let mut table = Self {
            form,
            fields: fields.to_vec(),
            stamps: Stamps::default(),
            joints: Vec::new(),
            columns: vec![Vec::new(); fields.len()],
            speed_scaling: Vec::new(),
            not_finite: vec![0; fields.len()],
            length_mismatch: vec![0; fields.len()],
            layout_changes: 0,
            message: Message { values: vec![Vec::new(); fields.len()], ..Message::default() },
            default_joints: joints.to_vec(),
            spare: Vec::new(),
        };
        table.set_layout(joints.to_vec());
        table
    }

    pub(in crate::log) fn len(&self) -> usize {
        self.stamps.len()
    }

    /// A column; empty if there is none.
    pub(in crate::log) fn column(&self, field: usize, joint: usize) -> &[f64] {
        self.columns.get(field).and_then(|joints| joints.get(joint)).map_or(&[], Vec::as_slice)
    }

    /// Moves a column out.
    pub(in crate::log) fn take_column(&mut self, field: usize, joint: usize) -> Vec<f64> {
        let column = self.columns.get_mut(field).and_then(|joints| joints.get_mut(joint));
        column.map(std::mem::take).unwrap_or_default()
    }

    /// Takes the message that was just read into the samples.
    pub(in crate::log) fn commit(&mut self, publish_ns: u64, log_ns: u64) {
        if self.form == Form::Groups {
            let names = std::mem::take(&mut self.message.group_names);
            if names != self.message.layout_names {
                self.set_layout(names);
            } else {
                self.message.group_names = names;
            }
        }
        let places = self.message.values.iter().map(Vec::len).max().unwrap_or(0);
        if self.message.layout_names.is_empty() && places > 0 {
            self.set_layout((1..=places).map(|place| format!("joint_{place}")).collect());
        }
        let rows = self.stamps.len();
        let message = &mut self.message;
        for (field, values) in message.values.iter().enumerate() {
            if values.len() != message.layout.len() {
                self.length_mismatch[field] += u64::from(!values.is_empty());
                continue;
            }
            let columns = &mut self.columns[field];
            let mut bad = 0;
            for (&joint, &value) in message.layout.iter().zip(values) {
                let column = &mut columns[joint];
                if column.len() != rows {
                    column.resize(rows, f64::NAN);
                }
                bad += u64::from(!value.is_finite());
                column.push(if value.is_finite() { value } else { f64::NAN });
            }
            self.not_finite[field] += bad;
        }
        if message.speed_scaling.is_finite() {
            self.speed_scaling.resize(rows, f64::NAN);
            self.speed_scaling.push(message.speed_scaling);
        }
        self.stamps.push(stamp_ns(message.second, message.nanosecond), publish_ns, log_ns);
    }

    /// Adds one sample given as (joint, field, value).
    pub(super) fn push_row<'a>(
        &mut self,
        header_ns: i64,
        publish_ns: i64,
        log_ns: i64,
        cells: impl Iterator<Item = (&'a str, usize, f64)>,
    ) {
        let rows = self.len();
        for (name, field, value) in cells {
            let joint = self.joint(name);
            self.not_finite[field] += u64::from(!value.is_finite());
            let column = &mut self.columns[field][joint];
            column.resize(rows, f64::NAN);
            column.push(if value.is_finite() { value } else { f64::NAN });
        }
        self.stamps.push_ns(header_ns, publish_ns, log_ns);
    }

    /// Appends the samples of another table of the same fields, and empties it for reuse.
    pub(in crate::log) fn append(&mut self, other: &mut Self) {
        if other.len() == 0 {
            return;
        }
        let rows = self.len();
        let joints: Vec<usize> = other.joints.iter().map(|name| self.joint(name)).collect();
        for (mine, theirs) in self.columns.iter_mut().zip(&mut other.columns) {
            for (&joint, column) in joints.iter().zip(theirs) {
                if !column.is_empty() {
                    mine[joint].resize(rows, f64::NAN);
                    mine[joint].extend_from_slice(column);
                }
            }
        }
        if !other.speed_scaling.is_empty() {
            self.speed_scaling.resize(rows, f64::NAN);
            self.speed_scaling.append(&mut other.speed_scaling);
        }
        self.stamps.append(&other.stamps);
        other.stamps.clear();
        for (mine, theirs) in self.not_finite.iter_mut().zip(&mut other.not_finite) {
            *mine += std::mem::take(theirs);
        }
        for (mine, theirs) in self.length_mismatch.iter_mut().zip(&mut other.length_mismatch) {
            *mine += std::mem::take(theirs);
        }
        self.layout_changes += std::mem::take(&mut other.layout_changes);
        other.forget_joints();
    }

    /// Back to the joints of a new table: what one run of messages named must not show in the
    /// order in which the next one names them.
    fn forget_joints(&mut self) {
        self.joints.clear();
        for mut column in self.columns.iter_mut().flat_map(std::mem::take) {
            column.clear();
            self.spare.push(column);
        }
        self.message.layout_raw.clear();
        self.message.layout_names.clear();
        self.set_layout(self.default_joints.clone());
    }

    /// The index of a joint, added if it is new.
    fn joint(&mut self, name: &str) -> usize {
        self.joints.iter().position(|joint| joint == name).unwrap_or_else(|| {
            self.joints.push(name.to_owned());
            for columns in &mut self.columns {
                columns.push(self.spare.pop().unwrap_or_default());
            }
            self.joints.len() - 1
        })
    }

    fn set_layout(&mut self, names: Vec<String>) {
        self.layout_changes += u64::from(!self.message.layout_names.is_empty());
        self.message.layout.clear();
        if names.len() > MAX_JOINTS || self.joints.len() > MAX_JOINTS {
            self.message.layout_names = names;
            return;
        }
        // A name that occurs again is another joint.
        let mut seen = BTreeMap::new();
        let mut layout = Vec::with_capacity(names.len());
        for name in &names {
            let count = seen.entry(name.clone()).and_modify(|count| *count += 1).or_insert(1_u32);
            let unique = if *count == 1 { name.clone() } else { format!("{name}#{count}") };
            layout.push(self.joint(&unique));
        }
        self.message.layout = layout;
        self.message.layout_names = names;
    }
}

impl Sink for Table {
    #[inline]
    fn number(&mut self, slot: Slot, value: f64) {
        match slot {
            slot::SECOND => self.message.second = value,
            slot::NANOSECOND => self.message.nanosecond = value,
            slot::SPEED_SCALING => self.message.speed_scaling = value,
            _ if slot >= slot::FIELD && self.message.groups > 0 => {
                self.numbers(slot, Numbers::Parsed(&[value]));
            }
            _ => {}
        }
    }

    fn text(&mut self, slot: Slot, text: &[u8]) {
        if slot == slot::NAMES && self.message.groups > 0 {
            let name = String::from_utf8_lossy(text).into_owned();
            self.message.group_names.push(name);
        }
    }

    #[inline]
    fn numbers(&mut self, slot: Slot, values: Numbers<'_>) {
        let message = &mut self.message;
        if slot == slot::VALUES {
            // One joint's values: its place in each field is the number of the group.
            let values = values.to_vec();
            for (into, place) in message.values.iter_mut().zip(&message.interface_places) {
                into.resize(message.groups - usize::from(message.groups > 0), f64::NAN);
                into.push(place.and_then(|place| values.get(place).copied()).unwrap_or(f64::NAN));
            }
        } else if let Some(into) =
            slot.checked_sub(slot::FIELD).and_then(|k| message.values.get_mut(usize::from(k)))
        {
            if message.groups > 0 {
                into.resize(message.groups - 1, f64::NAN);
                into.push(values.to_vec().first().copied().unwrap_or(f64::NAN));
            } else {
                into.clear();
                values.for_each(|value| into.push(value));
            }
        }
    }

    fn texts(&mut self, slot: Slot, values: Texts<'_>) {
        match slot {
            slot::NAMES => {
                if let Texts::Wire { raw, .. } = values {
                    self.message.layout_raw.clear();
                    self.message.layout_raw.extend_from_slice(raw);
                }
                let names = values.to_vec();
                // An empty list is no news: the names of the caller, or the last ones, stay.
                if names != self.message.layout_names && !names.is_empty() {
                    self.set_layout(names);
                }
            }
            slot::INTERFACES => {
                let names = values.to_vec();
                self.message.interface_places = self
                    .fields
                    .iter()
                    .map(|field| names.iter().position(|name| *name == field.path))
                    .collect();
            }
            _ => {}
        }
    }

    fn element(&mut self, slot: Slot) {
        match slot {
            Slot::MAX => {
                let message = &mut self.message;
                message.second = 0.0;
                message.nanosecond = 0.0;
                message.speed_scaling = f64::NAN;
                message.groups = 0;
                message.group_names.clear();
                message.values.iter_mut().for_each(Vec::clear);
            }
            slot::GROUP => {
                self.message.groups += 1;
                self.message.interface_places.clear();
            }
            _ => {}
        }
    }

    fn expected_texts(&self, slot: Slot) -> Option<&[u8]> {
        (slot == slot::NAMES && !self.message.layout_raw.is_empty()).then_some(&self.message.layout_raw)
    }

    fn same_texts(&mut self, _slot: Slot) {}
}
