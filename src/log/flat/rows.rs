//! Numbers of messages, put into rows.

use std::collections::{BTreeMap, BTreeSet};

use super::message::Cells;
use crate::log::{
    csv::{of_joint, says_side},
    write::Role,
};

/// Rows by their instant.
#[derive(Debug, Default)]
#[expect(clippy::struct_field_names, reason = "a table has rows")]
pub(super) struct Rows {
    /// Whether a measurement alone is looked for.
    pub(super) lone: bool,
    /// Topic and path of columns in the order of their appearance, parts between slashes.
    names: Vec<[String; 2]>,
    /// Topic and path to column; `None` of numbers that are not of joints.
    columns: BTreeMap<String, BTreeMap<String, Option<usize>>>,
    /// How many of these there are.
    seen: usize,
    rows: BTreeMap<i64, Vec<(usize, f64)>>,
    cells: usize,
    /// By column.
    stamps: Vec<Stamps>,
    /// Numbers of joints that are NaN or infinite.
    pub(super) not_finite: u64,
}

/// Stamps of the numbers of a column.
#[derive(Debug, Default)]
struct Stamps {
    numbers: usize,
    /// How many differ from the one before.
    moved: usize,
    last_ns: Option<i64>,
}

/// A log with more is not read like this: numbers by the hundred million are no joints.
const MOST_CELLS: usize = 60_000_000;
const MOST_COLUMNS: usize = 2_000;

/// Ends the name of a column that only its side tells to be of a joint.
pub(in crate::log) const LONE: &str = "/position";

impl Rows {
    /// Adds a message with its stamp, if it has one, and when it was published; `None` if there are too many.
    pub(super) fn add(
        &mut self,
        stamp_ns: Option<i64>,
        published_ns: i64,
        topic: &str,
        cells: Cells,
    ) -> Option<()> {
        if !self.columns.contains_key(topic) {
            self.columns.insert(topic.to_owned(), BTreeMap::new());
        }
        let Self { lone, names, columns, seen, rows, cells: count, stamps, not_finite } = self;
        let columns = columns.get_mut(topic)?;
        for (path, value) in cells {
            let path = match path.strip_prefix("data") {
                Some(rest) if rest.is_empty() || rest.starts_with('[') => rest,
                _ if path == "value" => "",
                _ => path.as_str(),
            };
            let column = columns.get(path).copied().unwrap_or_else(|| {
                let said = of_joint(&format!("{}/{path}", without_own(topic)));
                let other_side = |role| *lone && role != Role::Measured;
                let column = said.filter(|said| !said.role.is_some_and(other_side)).map(|_| {
                    names.push([topic.to_owned(), path.to_owned()]);
                    stamps.push(Stamps::default());
                    names.len() - 1
                });
                *seen += 1;
                columns.insert(path.to_owned(), column);
                column
            });
            let Some(column) = column else { continue };
            if !value.is_finite() {
                *not_finite += 1;
                continue;
            }
            stamps.get_mut(column)?.add(stamp_ns);
            let row = rows.entry(stamp_ns.unwrap_or(published_ns)).or_default();
            if row.iter().all(|(known, _)| *known != column) {
                row.push((column, value));
                *count += 1;
            }
        }
        (*count <= MOST_CELLS && names.len() <= MOST_COLUMNS && *seen <= 10 * MOST_COLUMNS).then_some(())
    }

    /// Whether the stamps of every column move.
    pub(super) fn run(&self) -> bool {
        self.stamps.iter().all(|stamps| 2 * stamps.moved >= stamps.numbers)
    }

    /// The table; `None` if it has no column. Of a measurement alone what says so is a position.
    pub(super) fn table(self) -> Option<Vec<u8>> {
        let lone = self.lone;
        if self.names.is_empty() {
            return None;
        }
        let mut writer = ::csv::Writer::from_writer(Vec::new());
        let mut names = short(&self.names);
        for name in names.iter_mut().filter(|name| lone && !of_joint(name).is_some_and(|said| said.alone)) {
            name.push_str(LONE);
        }
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

impl Stamps {
    fn add(&mut self, stamp_ns: Option<i64>) {
        self.numbers += 1;
        self.moved += usize::from(stamp_ns.is_some() && stamp_ns != self.last_ns);
        self.last_ns = stamp_ns;
    }
}

/// The names as short as they stay distinct: paths, behind the parts of the topics that say a side; else without what all
/// have in common; else whole.
fn short(names: &[[String; 2]]) -> Vec<String> {
    let parts =
        |[topic, path]: &[String; 2]| format!("{topic}/{path}").split('/').map(str::to_owned).collect();
    let all: Vec<Vec<String>> = names.iter().map(parts).collect();
    let join =
        |kept: Vec<&str>| kept.into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join("/");
    let sets = all.iter().map(|parts| parts.iter().map(String::as_str).collect::<BTreeSet<_>>());
    let shared = sets.reduce(|shared, parts| &shared & &parts).unwrap_or_default();
    let tells = |part: &str| says_side(part) || !shared.contains(part);
    let of_side = |[topic, path]: &[String; 2]| {
        let (before, last) = path.rsplit_once('/').unwrap_or(("", path));
        let topic = topic.split('/').filter(|part| path.is_empty() || says_side(part));
        join(topic.chain(before.split('/').filter(|part| tells(part))).chain([last]).collect())
    };
    let apart = |parts: &Vec<String>| {
        let last = parts.iter().rposition(|part| !part.is_empty());
        let kept = |(at, part): &(usize, &String)| Some(*at) == last || tells(part);
        join(parts.iter().enumerate().filter(kept).map(|(_, part)| plain(part)).collect())
    };
    let forms = [names.iter().map(of_side).collect(), all.iter().map(apart).collect::<Vec<_>>()];
    let distinct = |names: &&Vec<String>| names.iter().collect::<BTreeSet<_>>().len() == names.len();
    let whole = || all.iter().map(|parts| parts.join("/")).collect();
    forms.iter().find(distinct).cloned().unwrap_or_else(whole)
}

/// A controller is called after what it controls.
fn plain(part: &str) -> &str {
    part.strip_suffix("_controller").unwrap_or(part)
}

/// A topic without words for itself, which say nothing against its fields: `/arm_status`. Others do: `/tracking_error`.
fn without_own(topic: &str) -> String {
    const OWN: [&str; 4] = ["status", "robot", "safety", "runtime"];
    let parts = topic.split(['/', '_']).filter(|part| !OWN.contains(&part.to_ascii_lowercase().as_str()));
    parts.collect::<Vec<_>>().join("/")
}
