//! Finds the column that says of which joint a row is by how the rows change with it, whatever its header says.

use std::collections::{BTreeMap, BTreeSet};

use super::{
    head::Head,
    number::{Looks, looks, number},
};

/// Headers of columns that say of what a row is.
pub(super) const NAMES: [&str; 51] = [
    "joint", "joint_name", "joint name", "jointname", "motor_name", "axis_name", "joints", "name", "signal",
    "signals", "signalname", "variable", "variablename", "varname", "tag", "tagname", "channel", "field",
    "axis", "achse", "gelenk", "kanal", "topic", "metric", "parameter", "tag name", "tag_name", "tagpath",
    "tag_path", "symbol", "link", "motor", "actuator", "cylinder", "joint_id", "axis_id", "series", "key",
    "pen", "point", "pointname", "item", "curve", "trace", "element", "datapoint", "sensor", "path",
    "nodeid", "关节", "变量",
];

/// Rows of more joints are of none.
const MOST: usize = 64;
/// Such a column changes from row to row in so many of them: one that does not tells of steps or states.
const ALTERNATES: f64 = 0.3;
/// Values change from row to row so many times as much as from row to row of one joint.
const JUMPS: f64 = 3.0;
/// Rows an instant where each has its own row for each joint.
const SHARED: f64 = 1.5;
/// Fewer rows tell nothing.
const LEAST: usize = 12;

/// How the first rows of a table change.
pub(super) struct Changes<'a> {
    pub(super) head: &'a Head,
    pub(super) decimal_comma: bool,
    pub(super) times: &'a [usize],
    /// Columns of positions.
    pub(super) values: &'a [usize],
}

impl Changes<'_> {
    /// The first of some columns that tells joints apart.
    pub(super) fn key(&self, mut columns: impl Iterator<Item = usize>) -> Option<usize> {
        columns.find(|&column| {
            self.alternates(column)
                && (self.values_jump(column) || self.is_text(column) && self.shares(column))
        })
    }

    /// Whether the rows of a column's values come in turns, and hold values that jump with it.
    pub(super) fn is_interleaved(&self, column: usize) -> bool {
        self.alternates(column) && self.values_jump(column)
    }

    fn cells(&self, column: usize) -> impl Iterator<Item = &[u8]> {
        self.head.sample.iter().map(move |row| row.get(column).map_or(&[][..], |cell| cell.trim_ascii()))
    }

    fn is_text(&self, column: usize) -> bool {
        self.cells(column).all(|cell| looks(cell) == Looks::Text)
    }

    fn alternates(&self, column: usize) -> bool {
        let cells: Vec<&[u8]> = self.cells(column).collect();
        let kept = |cell: &&[u8]| matches!(looks(cell), Looks::Text | Looks::Whole);
        let distinct: BTreeSet<&[u8]> = cells.iter().copied().collect();
        let changes = cells.windows(2).filter(|pair| pair[0] != pair[1]).count();
        cells.len() >= LEAST
            && cells.iter().all(kept)
            && (2..=MOST.min(cells.len() / 3)).contains(&distinct.len())
            && changes as f64 >= ALTERNATES * (cells.len() - 1) as f64
    }

    /// Whether at least half of the values that change at all change far more from row to row than from row to row of
    /// one key.
    fn values_jump(&self, column: usize) -> bool {
        let (mut changing, mut jumping) = (0, 0);
        for &value in self.values.iter().filter(|value| **value != column) {
            let mut last: Option<f64> = None;
            let mut of_key: BTreeMap<&[u8], f64> = BTreeMap::new();
            let (mut any, mut own) = (0.0, 0.0);
            for (key, cell) in self.cells(column).zip(self.cells(value)) {
                let Some(x) = number(cell, self.decimal_comma) else { continue };
                any += last.replace(x).map_or(0.0, |before: f64| (x - before).abs());
                own += of_key.insert(key, x).map_or(0.0, |before| (x - before).abs());
            }
            changing += usize::from(any > 0.0);
            jumping += usize::from(any > JUMPS * own);
        }
        jumping > 0 && 2 * jumping >= changing
    }

    /// Whether instants have several rows, each of another key.
    fn shares(&self, column: usize) -> bool {
        let Some(&time) = self.times.first() else { return false };
        let instants: BTreeSet<&[u8]> = self.cells(time).collect();
        let pairs: BTreeSet<(&[u8], &[u8])> = self.cells(time).zip(self.cells(column)).collect();
        let rows = self.head.sample.len() as f64;
        rows >= SHARED * instants.len() as f64 && pairs.len() as f64 >= 0.95 * rows
    }
}
