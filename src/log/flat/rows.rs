//! Numbers of messages, put into rows.

use std::collections::{BTreeMap, BTreeSet};

use super::message::Cells;
use crate::log::csv::is_of_joint;

/// Rows by their instant.
#[derive(Debug, Default)]
#[expect(clippy::struct_field_names, reason = "a table has rows")]
pub(super) struct Rows {
    /// Names of columns in the order of their appearance: topic and path, parts between slashes.
    names: Vec<String>,
    /// Name to column; `None` of numbers that are not of joints.
    columns: BTreeMap<String, Option<usize>>,
    rows: BTreeMap<i64, Vec<(usize, f64)>>,
    cells: usize,
}

/// A log with more is not read like this: numbers by the hundred million are no joints.
const MOST_CELLS: usize = 60_000_000;
const MOST_COLUMNS: usize = 2_000;

impl Rows {
    /// Adds a message; `None` if there are too many.
    pub(super) fn add(&mut self, stamp_ns: i64, topic: &str, cells: Cells) -> Option<()> {
        let Self { names, columns, rows, cells: count } = self;
        for (path, value) in cells {
            let name = match path.as_str() {
                "data" | "value" => topic.to_owned(),
                path => format!("{topic}/{path}"),
            };
            let column = *columns.entry(name).or_insert_with_key(|name| {
                // A topic such as `/arm_status` says nothing against its fields.
                (is_of_joint(name) || is_of_joint(&path)).then(|| {
                    names.push(name.clone());
                    names.len() - 1
                })
            });
            let Some(column) = column.filter(|_| value.is_finite()) else { continue };
            let row = rows.entry(stamp_ns).or_default();
            if row.iter().all(|(known, _)| *known != column) {
                row.push((column, value));
                *count += 1;
            }
        }
        (*count <= MOST_CELLS && names.len() <= MOST_COLUMNS && columns.len() <= 10 * MOST_COLUMNS)
            .then_some(())
    }

    /// The table; `None` if it has no plan or no measurement to be.
    pub(super) fn table(self) -> Option<Vec<u8>> {
        if self.names.len() < 2 {
            return None;
        }
        let mut writer = ::csv::Writer::from_writer(Vec::new());
        let names = short(&self.names);
        writer.write_record(std::iter::once("stamp_ns").chain(names.iter().map(String::as_str))).ok()?;
        let mut line: Vec<String> = vec![String::new(); 1 + names.len()];
        for (stamp_ns, row) in self.rows {
            line.iter_mut().for_each(String::clear);
            line[0] = stamp_ns.to_string();
            for (column, value) in row {
                line[1 + column] = value.to_string();
            }
            writer.write_record(&line).ok()?;
        }
        writer.into_inner().ok()
    }
}

/// The names without the parts that all of them have, if they stay distinct.
fn short(names: &[String]) -> Vec<String> {
    let parts = |name: &String| name.split('/').map(str::to_owned).collect::<BTreeSet<_>>();
    let shared = names.iter().map(parts).reduce(|shared, parts| &shared & &parts).unwrap_or_default();
    let without = |name: &String| {
        let (before, last) = name.rsplit_once('/').unwrap_or(("", name));
        let kept = before.split('/').filter(|part| !shared.contains(*part));
        kept.chain([last]).collect::<Vec<_>>().join("/")
    };
    let short: Vec<String> = names.iter().map(without).collect();
    let distinct = short.iter().collect::<BTreeSet<_>>().len() == short.len();
    if distinct { short } else { names.to_vec() }
}
