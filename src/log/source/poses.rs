//! Poses of frames: one a message, a path of them, or transforms of many frames.

use super::{Field, Form, Role, Table, slot, table::stamp_ns};
use crate::log::decode::{Sink, Slot};

/// What the components of a pose are called where joints have names: x, y, z in m, then a unit quaternion.
pub(in crate::log) const AXES: [&str; 7] = ["x", "y", "z", "qx", "qy", "qz", "qw"];
/// Between a frame and its parent in the name of a transform; neither a shell nor a selector reads it otherwise.
pub(in crate::log) const IN: char = '@';
/// More frames than a machine has; more are not listed.
const MAX_FRAMES: usize = 64;

/// Poses of one topic.
#[derive(Debug, Clone, Default, PartialEq)]
pub(in crate::log) struct Poses {
    /// The only field where messages name no frames, else the frames that the caller named.
    fields: Vec<Field>,
    /// Whether each pose says which frame it is of.
    framed: bool,
    frames: Vec<Frame>,
    rows: Vec<Row>,
    /// Paths whose poses have no times of their own.
    pub(in crate::log) untimed: u64,
    message: Vec<Row>,
    stamp: (f64, f64),
    /// Frame and parent of the pose being read, where poses say which frame they are of.
    names: [String; 2],
    /// The frames that the others are told in, each once.
    told_in: Vec<String>,
}

/// A frame that poses are of; samples are kept of those in a role.
#[derive(Debug, Clone, PartialEq)]
struct Frame {
    name: String,
    role: Option<Role>,
}

#[derive(Debug, Clone, PartialEq)]
struct Row {
    header_ns: i64,
    publish_ns: i64,
    log_ns: i64,
    frame: Option<usize>,
    values: [f64; 7],
}

/// Whether a field is the one that the caller calls `asked`: a frame goes by its name alone or with its parent's.
pub(in crate::log) fn is_field(path: &str, asked: &str) -> bool {
    let asked = asked.trim_start_matches('/');
    path == asked || path.split_once(IN).is_some_and(|(frame, _)| frame == asked)
}

impl Poses {
    pub(in crate::log) fn new(fields: &[Field], framed: bool) -> Self {
        Self { fields: fields.to_vec(), framed, ..Self::default() }
    }

    pub(in crate::log) fn commit(&mut self, publish_ns: u64, log_ns: u64) {
        self.close_row();
        let rows = std::mem::take(&mut self.message);
        let is_path = rows.len() > 1 && !self.framed;
        if is_path && rows.windows(2).any(|pair| pair[1].header_ns <= pair[0].header_ns) {
            self.untimed += 1;
            return;
        }
        let first_ns = rows.first().map_or(0, |row| row.header_ns);
        let fit = |ns| i64::try_from(ns).unwrap_or(i64::MAX);
        for mut row in rows.into_iter().filter(|row| row.frame.is_some()) {
            // What is planned ahead is not late.
            let ahead_ns = if is_path { row.header_ns.saturating_sub(first_ns) } else { 0 };
            row.publish_ns = fit(publish_ns).saturating_add(ahead_ns);
            row.log_ns = fit(log_ns).saturating_add(ahead_ns);
            self.rows.push(row);
        }
    }

    /// The place of a frame; `None` if its samples are not wanted.
    fn frame(&mut self, name: &str) -> Option<usize> {
        let known = self.frames.iter().position(|frame| frame.name == name);
        let place = known.unwrap_or_else(|| {
            let field = self.fields.iter().find(|field| !self.framed || is_field(name, &field.path));
            // One that nobody named is wanted if it is the only one.
            let alone = self.frames.is_empty() && self.fields.is_empty();
            let role = field.map(|field| field.role).or(alone.then_some(Role::Beside));
            if role.is_some() || self.frames.len() < MAX_FRAMES {
                self.frames.push(Frame { name: name.to_owned(), role });
            }
            self.frames.len() - 1
        });
        self.frames.get(place).filter(|frame| frame.name == name && frame.role.is_some()).map(|_| place)
    }

    pub(in crate::log) fn append(&mut self, other: &mut Self) {
        let places: Vec<Option<usize>> =
            other.frames.drain(..).map(|frame| self.frame(&frame.name)).collect();
        let rows = other.rows.drain(..);
        let own = |row: Row| Some(Row { frame: Some(places[row.frame?]?), ..row });
        self.rows.extend(rows.filter_map(own));
        self.untimed += std::mem::take(&mut other.untimed);
        other.told_in.drain(..).for_each(|frame| self.tell_in(frame.as_bytes()));
    }

    fn tell_in(&mut self, frame: &[u8]) {
        let frame = frame.strip_prefix(b"/").unwrap_or(frame);
        let known = self.told_in.iter().any(|known| known.as_bytes() == frame);
        if !known && !frame.is_empty() && self.told_in.len() < MAX_FRAMES {
            self.told_in.push(String::from_utf8_lossy(frame).into_owned());
        }
    }

    /// The poses as samples, a table a frame, the components in place of joints; empty for frames that nobody named. A
    /// later path replaces the rest of the one before.
    pub(in crate::log) fn to_tables(&self, is_path: bool) -> Vec<Table> {
        let table = |(place, frame): (usize, &Frame)| {
            let role = frame.role.unwrap_or(Role::Beside);
            let field = Field { path: frame.name.clone(), role, velocity: None, is_velocity: false };
            let mut rows: Vec<&Row> = Vec::with_capacity(self.rows.len());
            for row in self.rows.iter().filter(|row| row.frame == Some(place)) {
                while is_path && rows.last().is_some_and(|last| last.header_ns >= row.header_ns) {
                    rows.pop();
                }
                rows.push(row);
            }
            let mut table = Table::new(Form::Poses, &[field], &[], None);
            table.told_in.clone_from(&self.told_in);
            let mut before = [0.0; 4];
            for row in rows {
                let [x, y, z, orientation @ ..] = row.values;
                let orientation = unit(orientation, &before);
                before = orientation.unwrap_or(before);
                let cells = [x, y, z].into_iter().chain(orientation.into_iter().flatten());
                let cells = AXES.iter().zip(cells).map(|(axis, value)| (*axis, 0, value));
                table.push_row(row.header_ns, row.publish_ns, row.log_ns, cells);
            }
            table
        };
        let tables = self.frames.iter().enumerate().map(table);
        tables.filter(|table| self.framed || table.len() > 0).collect()
    }

    fn close_row(&mut self) {
        let header_ns = stamp_ns(self.stamp.0, self.stamp.1);
        if self.message.is_empty() {
            return;
        }
        let [frame, parent] = &self.names;
        let name = match self.fields.first() {
            Some(field) if !self.framed => field.path.clone(),
            _ => format!("{frame}{IN}{parent}"),
        };
        let frame = self.frame(&name);
        if let Some(last) = self.message.last_mut() {
            (last.header_ns, last.frame) = (header_ns, frame);
        }
    }

    fn open_row(&mut self) {
        self.close_row();
        let values = [f64::NAN; 7];
        self.message.push(Row { header_ns: 0, publish_ns: 0, log_ns: 0, frame: None, values });
    }
}

/// A unit quaternion of the same sign as the one before, as both signs are one orientation; `None` for none.
pub(in crate::log) fn unit(q: [f64; 4], before: &[f64; 4]) -> Option<[f64; 4]> {
    let norm = q.iter().map(|v| v * v).sum::<f64>().sqrt();
    // Messages that give no orientation hold zeros.
    if !(norm.is_finite() && norm > 0.1) {
        return None;
    }
    let along: f64 = q.iter().zip(before).map(|(a, b)| a * b).sum();
    Some(q.map(|v| if along < 0.0 { -v / norm } else { v / norm }))
}

impl Sink for Poses {
    fn number(&mut self, slot: Slot, value: f64) {
        if self.message.is_empty() {
            self.open_row();
        }
        match slot {
            slot::SECOND => self.stamp.0 = value,
            slot::NANOSECOND => self.stamp.1 = value,
            slot => {
                let place = usize::from(slot.saturating_sub(slot::FIELD));
                if let Some(cell) = self.message.last_mut().and_then(|row| row.values.get_mut(place)) {
                    *cell = value;
                }
            }
        }
    }

    fn text(&mut self, slot: Slot, text: &[u8]) {
        if !self.framed && slot == slot::PARENT {
            self.tell_in(text);
        } else if let Some(name) = [slot::CHILD, slot::PARENT].iter().position(|own| *own == slot) {
            String::from_utf8_lossy(text).trim_start_matches('/').clone_into(&mut self.names[name]);
        }
    }

    fn element(&mut self, slot: Slot) {
        if slot == Slot::MAX {
            self.message.clear();
        } else if slot == slot::GROUP {
            self.open_row();
        }
        self.stamp = (0.0, 0.0);
        self.names.iter_mut().for_each(String::clear);
    }
}
