//! How a file was read, for a person to check.

use serde::{Deserialize, Serialize};

use super::{
    dialect::Dialect, head::Head, layout::Layout, options::describe, read::Cells, si::Settled,
    time::TimeSource,
};
use crate::{
    math::usual_step,
    units::{NS_PER_S, seconds_since},
};

/// How a file was read.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Understood {
    /// Its name.
    pub file: String,
    /// Between its cells.
    pub separator: String,
    /// "comma" or "point".
    pub decimal: String,
    /// Line of its header, 0 if it has none.
    pub header_line: u64,
    /// Whether a row of units follows.
    pub unit_row: bool,
    /// Rows above the header that were passed over.
    pub rows_above: usize,
    /// Rows that became samples.
    pub rows: usize,
    /// Its clock.
    pub time: TimeRead,
    /// The joints, in the order of the log.
    pub joints: Vec<String>,
    /// Columns in use, in the order of the file.
    pub columns: Vec<ColumnRead>,
    /// Headers of the others.
    pub unused: Vec<String>,
}

/// How rows were given their times.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct TimeRead {
    /// Headers of its columns; none where a rate was given.
    pub columns: Vec<String>,
    /// Unit or form of the times.
    pub form: String,
    /// Whether they say the date; if not, they count from a fixed one.
    pub absolute: bool,
    /// Stamp of the first sample, ns since 1970.
    pub first_ns: i64,
    /// From the first to the last sample, s.
    pub duration_s: f64,
    /// By the usual interval, Hz.
    pub rate_hz: f64,
}

/// The use of a column.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct ColumnRead {
    /// Its number, from 1.
    pub number: usize,
    /// Its header.
    pub header: String,
    /// Such as "planned position".
    pub becomes: String,
    /// Of which joint.
    pub joint: String,
    /// Its unit in the file; `None` where it was kept as it is.
    pub unit: Option<String>,
    /// Who says so: "file", "option", "RTDE", "guess", "as given".
    pub unit_from: String,
    /// Cells with a number.
    pub numbers: u64,
    /// Cells without.
    pub empty: u64,
}

impl Understood {
    pub(super) fn new(
        file: &str,
        dialect: Dialect,
        head: &Head,
        time: &TimeSource,
        (layout, added): (&Layout, Vec<usize>),
        cells: &Cells,
        units: &[Settled],
    ) -> Self {
        let rows = cells.stamp_ns.len();
        let (first_ns, last_ns) = (cells.stamp_ns.first().copied(), cells.stamp_ns.last().copied());
        let (first_ns, last_ns) = (first_ns.unwrap_or_default(), last_ns.unwrap_or_default());
        let steps =
            cells.stamp_ns.windows(2).map(|w| seconds_since(w[0], w[1])).filter(|step_s| *step_s > 0.0);
        let steps: Vec<f64> = steps.collect();
        let rate_hz = if steps.is_empty() { 0.0 } else { 1.0 / usual_step(&steps) };
        let of = |column: usize, becomes: String, joint: usize| {
            let settled = units.iter().find(|settled| settled.column == column);
            let numbers = cells.columns.get(&column).map_or(0, |column| column.numbers);
            ColumnRead {
                number: column + 1,
                header: head.names[column].clone(),
                becomes,
                joint: layout.joints[joint].clone(),
                unit: settled.and_then(|settled| settled.unit).map(|unit| unit.name.to_owned()),
                unit_from: settled.map_or("as given", |settled| settled.from).to_owned(),
                numbers,
                empty: (rows as u64).saturating_sub(numbers),
            }
        };
        let uses = layout.uses.iter().map(|one| of(one.column, describe(one.role, one.quantity), one.joint));
        let interfaces = layout.interfaces.iter().map(|one| of(one.column, one.name.clone(), one.joint));
        let mut columns: Vec<ColumnRead> = uses.chain(interfaces).collect();
        columns.sort_by_key(|column| column.number);
        let taken = time.columns();
        // A trailing separator, or a time of other signals, is no column.
        let is_column = |column: usize| {
            let cell = |row: &Vec<Vec<u8>>| row.get(column).is_some_and(|cell| !cell.trim_ascii().is_empty());
            head.written.get(column).is_some_and(|name| !name.is_empty()) || head.sample.iter().any(cell)
        };
        let unused = (0..head.names.len()).filter(|column| {
            is_column(*column)
                && !taken.contains(column)
                && !added.contains(column)
                && !columns.iter().any(|used| used.number == column + 1)
        });
        Self {
            file: file.to_owned(),
            separator: dialect.separator.name(),
            decimal: if dialect.decimal_comma { "comma" } else { "point" }.to_owned(),
            header_line: head.line,
            unit_row: head.units.is_some(),
            rows_above: head.above,
            rows,
            time: TimeRead {
                columns: taken.iter().map(|&column| head.names[column].clone()).collect(),
                form: time.form(),
                absolute: cells.absolute,
                first_ns,
                duration_s: (i128::from(last_ns) - i128::from(first_ns)) as f64 / NS_PER_S,
                rate_hz,
            },
            joints: layout.joints.clone(),
            unused: unused.map(|column| head.names[column].clone()).collect(),
            columns,
        }
    }
}
