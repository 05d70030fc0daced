//! Samples of one topic, one column for each field and joint.

use std::collections::BTreeMap;

mod alike;
mod lists;
mod message;
mod places;
mod stamps;

pub(in crate::log) use lists::Rows;
pub(in crate::log) use stamps::Stamps;
pub(super) use stamps::stamp_ns;

use super::{Field, Form};
use alike::Alike;
use lists::Lists;
use message::{Message, Names};
use places::InterfacePlaces;

/// Samples of one topic.
#[derive(Debug, Clone, Default, PartialEq)]
pub(in crate::log) struct Table {
    pub(in crate::log) form: Form,
    pub(in crate::log) fields: Vec<Field>,
    pub(in crate::log) stamps: Stamps,
    /// Joint names in the order of their first appearance.
    pub(in crate::log) joints: Vec<String>,
    /// `[field][joint][sample]`; NaN where a message lacks the joint or the number. A column is
    /// empty if no message had it, and ends with the last message that did.
    pub(in crate::log) columns: Vec<Vec<Vec<f64>>>,
    /// Speed scalings in the order of the samples, and how many in a row have each; mostly there is one.
    pub(in crate::log) speed_scaling: Vec<(f64, u64)>,
    /// Numbers in the data that are NaN or infinite, by field.
    pub(in crate::log) not_finite: Vec<u64>,
    /// Messages whose array is not as long as the list of names, by field.
    pub(in crate::log) length_mismatch: Vec<u64>,
    /// Messages and columns left out because there are too many joints.
    pub(in crate::log) too_many: u64,
    /// The frames that poses are told in; empty where messages name none.
    pub(in crate::log) told_in: Vec<String>,
    /// Rows that are to come, where that is known: room for them is made once.
    pub(in crate::log) expected: usize,
    message: Message,
    layout: Layout,
    lists: Lists,
    /// Names to use where messages carry none.
    default_joints: Vec<String>,
    /// Name to use for one number without one.
    alone: Option<String>,
    interfaces: InterfacePlaces,
    /// Joint to its index.
    index: BTreeMap<String, usize>,
    /// Emptied columns, kept for their memory.
    spare: Vec<Vec<f64>>,
    alike: Alike,
}

/// No arm has more; a topic that names more is not about joints.
pub(in crate::log) const MAX_JOINTS: usize = 512;

/// The joints of the last message.
#[derive(Debug, Clone, Default, PartialEq)]
struct Layout {
    names: Vec<String>,
    /// The bytes that `names` came from.
    raw: Vec<u8>,
    /// Place in the message to joint; `None` for a joint without a name.
    places: Vec<Option<usize>>,
    /// Set for a message of so many places and no names.
    nameless: Option<usize>,
    too_many: bool,
}

/// Makes room for the rows of a column at its beginning; where there is none, the column grows as it comes.
pub(super) fn make_room<T>(column: &mut Vec<T>, rows: usize) {
    if column.capacity() == 0 {
        let _ = column.try_reserve_exact(rows);
    }
}

/// Adds a speed scaling that so many samples in a row have; one that is no number says nothing.
#[inline]
fn add_scaling(all: &mut Vec<(f64, u64)>, (factor, samples): (f64, u64)) {
    match all.last_mut() {
        Some((last, count)) if last.to_bits() == factor.to_bits() => *count += samples,
        _ if factor.is_finite() => all.push((factor, samples)),
        _ => {}
    }
}

impl Table {
    /// `joints` are the names to use where messages carry none, `alone` that for a single number.
    pub(in crate::log) fn new(form: Form, fields: &[Field], joints: &[String], alone: Option<&str>) -> Self {
        Self {
            form,
            fields: fields.to_vec(),
            columns: vec![Vec::new(); fields.len()],
            not_finite: vec![0; fields.len()],
            length_mismatch: vec![0; fields.len()],
            message: Message {
                values: vec![Vec::new(); fields.len()],
                absent: vec![0; fields.len()],
                ..Message::default()
            },
            default_joints: joints.to_vec(),
            alone: alone.map(str::to_owned),
            ..Self::default()
        }
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
        self.forget_alike();
        self.message.close_groups();
        self.lay_out();
        let rows = self.stamps.len();
        let (message, layout) = (&self.message, &self.layout);
        self.too_many += u64::from(layout.too_many && message.places() > 0);
        for (field, values) in message.values.iter().enumerate() {
            if layout.too_many || values.len() != layout.places.len() {
                self.length_mismatch[field] += u64::from(!layout.too_many && !values.is_empty());
                continue;
            }
            let columns = &mut self.columns[field];
            let mut bad = 0_u64;
            for (joint, &value) in layout.places.iter().zip(values) {
                bad += u64::from(!value.is_finite());
                let Some(joint) = *joint else { continue };
                let column = &mut columns[joint];
                if column.len() != rows {
                    column.resize(rows, f64::NAN);
                }
                column.push(if value.is_finite() { value } else { f64::NAN });
            }
            self.not_finite[field] += bad.saturating_sub(message.absent[field]);
        }
        add_scaling(&mut self.speed_scaling, (message.speed_scaling, 1));
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
            let Some(joint) = self.joint(name) else {
                self.too_many += 1;
                continue;
            };
            self.not_finite[field] += u64::from(!value.is_finite());
            let column = &mut self.columns[field][joint];
            column.resize(rows, f64::NAN);
            column.push(if value.is_finite() { value } else { f64::NAN });
        }
        self.stamps.push_ns(header_ns, publish_ns, log_ns);
    }

    /// Appends the samples of another table of the same fields, and empties it for reuse.
    pub(in crate::log) fn append(&mut self, other: &mut Self) {
        other.flush();
        let (rows, expected) = (self.len(), self.expected);
        let joints: Vec<Option<usize>> = other.joints.iter().map(|name| self.joint(name)).collect();
        for (mine, theirs) in self.columns.iter_mut().zip(&mut other.columns) {
            for (joint, column) in joints.iter().zip(theirs).filter(|(_, column)| !column.is_empty()) {
                match *joint {
                    Some(joint) => {
                        make_room(&mut mine[joint], expected);
                        mine[joint].resize(rows, f64::NAN);
                        mine[joint].extend_from_slice(column);
                    }
                    None => self.too_many += 1,
                }
            }
        }
        other.speed_scaling.drain(..).for_each(|scaling| add_scaling(&mut self.speed_scaling, scaling));
        self.stamps.append(&other.stamps, expected);
        for (mine, theirs) in self.not_finite.iter_mut().zip(&other.not_finite) {
            *mine += theirs;
        }
        for (mine, theirs) in self.length_mismatch.iter_mut().zip(&other.length_mismatch) {
            *mine += theirs;
        }
        self.lists.append(&other.lists, rows, &joints);
        self.too_many += other.too_many;
        self.interfaces.append(&mut other.interfaces);
        if !other.layout.names.is_empty() {
            self.layout.names = std::mem::take(&mut other.layout.names);
        }
        other.reset();
    }

    /// Back to a new table: what one run of messages named must not show in the order in which
    /// the next one names them.
    fn reset(&mut self) {
        for mut column in self.columns.iter_mut().flat_map(std::mem::take) {
            column.clear();
            self.spare.push(column);
        }
        let spare = std::mem::take(&mut self.spare);
        let (fields, joints) = (std::mem::take(&mut self.fields), std::mem::take(&mut self.default_joints));
        let stamps = std::mem::take(&mut self.stamps);
        let alone = self.alone.take();
        *self = Self { spare, ..Self::new(self.form, &fields, &joints, alone.as_deref()) };
        self.stamps = stamps;
        self.stamps.clear();
    }

    /// The index of a joint, added if it is new; `None` if there are too many.
    fn joint(&mut self, name: &str) -> Option<usize> {
        if let Some(&known) = self.index.get(name) {
            return Some(known);
        }
        let joint = self.joints.len();
        if joint >= MAX_JOINTS {
            return None;
        }
        self.joints.push(name.to_owned());
        self.index.insert(name.to_owned(), joint);
        for columns in &mut self.columns {
            columns.push(self.spare.pop().unwrap_or_default());
        }
        Some(joint)
    }

    /// Finds the joint of each place of the message. Each message speaks for itself: one without
    /// names does not borrow those of the message before.
    fn lay_out(&mut self) {
        match std::mem::take(&mut self.message.names) {
            Names::Same => {}
            Names::Listed(names) if !names.is_empty() => {
                std::mem::swap(&mut self.layout.raw, &mut self.message.raw);
                self.layout.nameless = None;
                if names != self.layout.names {
                    self.set_layout(names);
                }
            }
            Names::None | Names::Listed(_) => {
                let places = self.message.places();
                if places == 0 || self.layout.nameless == Some(places) {
                    return;
                }
                let names: Vec<String> = if let Some(alone) = self.alone.as_ref().filter(|_| places == 1) {
                    vec![alone.clone()]
                } else if self.default_joints.is_empty() {
                    (1..=places.min(MAX_JOINTS + 1)).map(|place| format!("joint_{place}")).collect()
                } else {
                    self.default_joints.clone()
                };
                self.layout.raw.clear();
                self.layout.nameless = Some(places);
                if names != self.layout.names {
                    self.set_layout(names);
                }
            }
        }
    }

    fn set_layout(&mut self, names: Vec<String>) {
        self.layout.places.clear();
        let new = names.iter().filter(|name| !self.index.contains_key(*name)).count();
        self.layout.too_many = names.len() > MAX_JOINTS || self.joints.len() + new > MAX_JOINTS;
        if !self.layout.too_many {
            // A name that occurs again is another joint.
            let mut seen = BTreeMap::new();
            for name in &names {
                let count = seen.entry(name.as_str()).and_modify(|count| *count += 1).or_insert(1_u32);
                let joint = match *count {
                    _ if name.is_empty() => None,
                    1 => self.joint(name),
                    again => self.joint(&format!("{name}#{again}")),
                };
                self.layout.places.push(joint);
            }
        }
        self.layout.names = names;
        self.lists.begin(self.stamps.len(), &self.layout.places);
    }
}
