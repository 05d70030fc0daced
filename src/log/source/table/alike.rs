//! Messages laid out as one before them: their numbers lie at known places, and are stored in blocks.

use super::{Table, add_scaling, stamp_ns};
use crate::{
    log::{
        decode::{Found, LayoutCache, Template, number_from},
        schema::Number,
        source::slot,
    },
    series::all_finite,
};

/// Rows that are stored at once.
const ROWS: usize = 64;
/// After so many layouts in a row that no message shared, none is learnt.
const MOST_TRIES: u32 = 8;

/// How messages are read without a walk, and the rows that are not in the columns yet.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Alike {
    layout: Option<Layout>,
    tries: u32,
    /// Field and joint of each cell of a row.
    cells: Vec<(usize, usize)>,
    /// `[cell][row]`.
    block: Vec<[f64; ROWS]>,
    rows: usize,
}

/// Where the numbers of messages lie that fit a template.
#[derive(Debug, Clone, PartialEq)]
struct Layout {
    channel: u16,
    template: Template,
    second: Option<Place>,
    nanosecond: Option<Place>,
    speed_scaling: Option<Place>,
    /// The first byte of a list of numbers, the cell of the first of them, and their count.
    lists: Vec<[usize; 3]>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Place {
    number: Number,
    at: usize,
}

impl Place {
    #[inline]
    fn read(self, body: &[u8]) -> Option<f64> {
        let bytes = body.get(self.at..)?;
        Some(match self.number {
            Number::I32 => f64::from(i32::from_le_bytes(*bytes.first_chunk()?)),
            Number::U32 => f64::from(u32::from_le_bytes(*bytes.first_chunk()?)),
            Number::F64 => f64::from_le_bytes(*bytes.first_chunk()?),
            other => number_from(other, true, bytes.get(..usize::from(other.size()))?),
        })
    }
}

impl Table {
    /// Takes in a message that is laid out as the one learnt from; `false`, and nothing is taken, if it is not.
    #[inline]
    pub(in crate::log) fn take_alike(&mut self, channel: u16, body: &[u8], times_ns: [u64; 2]) -> bool {
        let Some(layout) = self.alike.layout.as_ref() else { return false };
        if layout.channel != channel || !layout.template.fits(body) {
            return false;
        }
        let read = |place: Option<Place>, absent: f64| place.map_or(Some(absent), |place| place.read(body));
        let (Some(second), Some(nanosecond), Some(scaling)) =
            (read(layout.second, 0.0), read(layout.nanosecond, 0.0), read(layout.speed_scaling, f64::NAN))
        else {
            return false;
        };
        let row = self.alike.rows % ROWS;
        for &[at, cell, count] in &layout.lists {
            let bytes = body.get(at..).unwrap_or_default().as_chunks().0;
            let cells = self.alike.block.get_mut(cell..).unwrap_or_default();
            for (into, eight) in cells.iter_mut().zip(bytes).take(count) {
                into[row] = f64::from_le_bytes(*eight);
            }
        }
        add_scaling(&mut self.speed_scaling, (scaling, 1));
        self.alike.tries = 0;
        self.alike.rows = row + 1;
        self.stamps.push(stamp_ns(second, nanosecond), times_ns[0], times_ns[1]);
        if self.alike.rows == ROWS {
            self.flush();
        }
        true
    }

    /// Learns from the message that was taken in last.
    pub(in crate::log) fn learn(&mut self, channel: u16, body: &[u8], cache: &LayoutCache) {
        if self.alike.tries < MOST_TRIES {
            self.alike.tries += 1;
            self.alike.layout = self.layout_of(channel, body, cache);
        }
    }

    /// The layout of a message, if every one that fits its template is taken in as it was: no groups, each list as long
    /// as there are joints, each column once.
    fn layout_of(&mut self, channel: u16, body: &[u8], cache: &LayoutCache) -> Option<Layout> {
        let (fields, counts) = cache.learnt()?;
        let joints: Option<Vec<usize>> = self.layout.places.iter().copied().collect();
        let joints = joints.filter(|_| !self.layout.too_many)?;
        let mut distinct = joints.clone();
        distinct.sort_unstable();
        distinct.dedup();
        if distinct.len() < joints.len() {
            return None;
        }
        let (mut second, mut nanosecond, mut speed_scaling) = (None, None, None);
        let (mut names, mut lists) = (None, Vec::new());
        self.alike.cells.clear();
        for found in fields {
            match *found {
                Found::Number(slot::SECOND, number, at, _) => second = Some(Place { number, at }),
                Found::Number(slot::NANOSECOND, number, at, _) => nanosecond = Some(Place { number, at }),
                Found::Number(slot::SPEED_SCALING, number, at, _) => {
                    speed_scaling = Some(Place { number, at });
                }
                Found::Texts(slot::NAMES, from, to) if names.is_none() => names = Some(from..to),
                Found::Number(.., from, to) | Found::Numbers(.., from, to) if from == to => {}
                Found::Number(slot, Number::F64, from, to) | Found::Numbers(slot, Number::F64, from, to) => {
                    let field = usize::from(slot.checked_sub(slot::FIELD)?);
                    let new = field < self.columns.len() && self.alike.cells.iter().all(|(f, _)| *f != field);
                    if !new || to - from != joints.len() * size_of::<f64>() {
                        return None;
                    }
                    lists.push([from, self.alike.cells.len(), joints.len()]);
                    self.alike.cells.extend(joints.iter().map(|&joint| (field, joint)));
                }
                _ => return None,
            }
        }
        self.alike.block.resize(self.alike.cells.len(), [f64::NAN; ROWS]);
        let template = Template::of(body, counts.chain(names))?;
        Some(Layout { channel, template, second, nanosecond, speed_scaling, lists })
    }

    /// Puts the rows that wait into the columns.
    pub(super) fn flush(&mut self) {
        let rows = std::mem::take(&mut self.alike.rows);
        if rows == 0 {
            return;
        }
        let before = self.stamps.len() - rows;
        for (&(field, joint), values) in self.alike.cells.iter().zip(&self.alike.block) {
            let column = &mut self.columns[field][joint];
            column.resize(before, f64::NAN);
            self.not_finite[field] += extend_finite(column, &values[..rows]);
        }
    }

    /// What comes next may be laid out otherwise.
    pub(super) fn forget_alike(&mut self) {
        self.flush();
        self.alike.layout = None;
    }
}

/// Appends values, NaN for those that are not finite; returns how many these were.
fn extend_finite(column: &mut Vec<f64>, values: &[f64]) -> u64 {
    let start = column.len();
    column.extend_from_slice(values);
    if all_finite(values) {
        return 0;
    }
    let bad = column[start..].iter_mut().filter(|value| !value.is_finite());
    bad.map(|value| *value = f64::NAN).count() as u64
}
