//! Poses of frames: one a message, a path of them, or transforms of many frames.

use super::{Field, Form, Role, Table, slot, table::stamp_ns};
use crate::log::decode::{Numbers, Sink, Slot, Texts};

/// What the components of a pose are called where joints have names: x, y, z in m, then a unit quaternion.
pub(in crate::log) const AXES: [&str; 7] = ["x", "y", "z", "qx", "qy", "qz", "qw"];
/// More frames than a machine has; more are left out.
const MAX_FRAMES: usize = 64;

/// Poses of one topic.
#[derive(Debug, Clone, Default, PartialEq)]
pub(in crate::log) struct Poses {
    /// Frames that are wanted; none: the only one, or all.
    fields: Vec<Field>,
    frames: Vec<String>,
    rows: Vec<Row>,
    /// Paths whose poses have no times of their own.
    pub(in crate::log) untimed: u64,
    message: Vec<Row>,
    names: Vec<Option<String>>,
    stamp: (f64, f64),
}

#[derive(Debug, Clone, PartialEq)]
struct Row {
    header_ns: i64,
    publish_ns: i64,
    log_ns: i64,
    frame: usize,
    values: [f64; 7],
}

impl Poses {
    pub(in crate::log) fn new(fields: &[Field]) -> Self {
        Self { fields: fields.to_vec(), ..Self::default() }
    }

    pub(in crate::log) fn commit(&mut self, publish_ns: u64, log_ns: u64) {
        self.close_row();
        let rows = std::mem::take(&mut self.message);
        let names = std::mem::take(&mut self.names);
        let is_path = rows.len() > 1 && names.iter().all(Option::is_none);
        if is_path && rows.windows(2).any(|pair| pair[1].header_ns <= pair[0].header_ns) {
            self.untimed += 1;
            return;
        }
        let first_ns = rows.first().map_or(0, |row| row.header_ns);
        let fit = |ns| i64::try_from(ns).unwrap_or(i64::MAX);
        for (mut row, name) in rows.into_iter().zip(names) {
            let name =
                name.unwrap_or_else(|| self.fields.first().map_or_else(String::new, |f| f.path.clone()));
            let Some(frame) = self.frame(&name) else { continue };
            // What is planned ahead is not late.
            let ahead_ns = if is_path { row.header_ns.saturating_sub(first_ns) } else { 0 };
            row.publish_ns = fit(publish_ns).saturating_add(ahead_ns);
            row.log_ns = fit(log_ns).saturating_add(ahead_ns);
            row.frame = frame;
            self.rows.push(row);
        }
    }

    /// The place of a frame; `None` if it is not wanted.
    fn frame(&mut self, name: &str) -> Option<usize> {
        let known = self.frames.iter().position(|frame| frame == name);
        let wanted = self.fields.is_empty() || self.fields.iter().any(|field| field.path == name);
        known.or_else(|| {
            (wanted && self.frames.len() < MAX_FRAMES).then(|| {
                self.frames.push(name.to_owned());
                self.frames.len() - 1
            })
        })
    }

    pub(in crate::log) fn append(&mut self, other: &mut Self) {
        let places: Vec<Option<usize>> = other.frames.iter().map(|name| self.frame(name)).collect();
        let rows = other.rows.drain(..);
        self.rows.extend(rows.filter_map(|row| Some(Row { frame: places[row.frame]?, ..row })));
        self.untimed += std::mem::take(&mut other.untimed);
        other.frames.clear();
    }

    /// The poses as samples, a field a frame, the components in place of joints. A later path replaces the rest of the
    /// one before.
    pub(in crate::log) fn to_table(&self, is_path: bool) -> Option<Table> {
        let named = |name: &String| self.fields.iter().find(|field| field.path == *name).cloned();
        let field = |name: &String| Field {
            path: name.clone(),
            role: Role::Beside,
            velocity: None,
            is_velocity: false,
        };
        let fields: Vec<Field> =
            self.frames.iter().map(|name| named(name).unwrap_or_else(|| field(name))).collect();
        let mut rows: Vec<&Row> = Vec::with_capacity(self.rows.len());
        for row in &self.rows {
            while is_path && rows.last().is_some_and(|last| last.header_ns >= row.header_ns) {
                rows.pop();
            }
            rows.push(row);
        }
        let mut table = Table::new(Form::Poses, &fields, &[], None);
        let mut before = vec![[0.0; 4]; fields.len()];
        for row in rows {
            let [x, y, z, orientation @ ..] = row.values;
            let orientation = unit(orientation, &mut before[row.frame]);
            let cells = [x, y, z].into_iter().chain(orientation.into_iter().flatten());
            let cells = AXES.iter().zip(cells).map(|(axis, value)| (*axis, row.frame, value));
            table.push_row(row.header_ns, row.publish_ns, row.log_ns, cells);
        }
        (table.len() > 0).then_some(table)
    }

    fn close_row(&mut self) {
        if let Some(last) = self.message.last_mut() {
            last.header_ns = stamp_ns(self.stamp.0, self.stamp.1);
        }
    }

    fn open_row(&mut self) {
        self.close_row();
        let values = [f64::NAN; 7];
        self.message.push(Row { header_ns: 0, publish_ns: 0, log_ns: 0, frame: 0, values });
        self.names.push(None);
    }
}

/// A unit quaternion of the same sign as the one before, as both signs are one orientation; `None` for none.
fn unit(q: [f64; 4], before: &mut [f64; 4]) -> Option<[f64; 4]> {
    let norm = q.iter().map(|v| v * v).sum::<f64>().sqrt();
    // Messages that give no orientation hold zeros.
    if !(norm.is_finite() && norm > 0.1) {
        return None;
    }
    let along: f64 = q.iter().zip(&*before).map(|(a, b)| a * b).sum();
    let scale = if along < 0.0 { -norm } else { norm };
    *before = q.map(|v| v / scale);
    Some(*before)
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
        if let Some(name) = self.names.last_mut().filter(|_| slot == slot::NAMES) {
            *name = Some(String::from_utf8_lossy(text).trim_start_matches('/').to_owned());
        }
    }

    fn numbers(&mut self, _slot: Slot, _values: Numbers<'_>) {}

    fn texts(&mut self, _slot: Slot, _values: Texts<'_>) {}

    fn element(&mut self, slot: Slot) {
        if slot == Slot::MAX {
            self.message.clear();
            self.names.clear();
        } else if slot == slot::GROUP {
            self.open_row();
        }
        self.stamp = (0.0, 0.0);
    }

    fn expected_texts(&self, _slot: Slot) -> Option<&[u8]> {
        None
    }

    fn same_texts(&mut self, _slot: Slot) {}
}
