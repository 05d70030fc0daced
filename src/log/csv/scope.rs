//! Recordings of a controller's oscilloscope: above the numbers stand rows of properties, in which a key stands before
//! each signal, or before the signals of a clock, and below it the times of that clock.

use std::collections::BTreeSet;

use super::{
    Separator,
    label::label,
    number::number,
    rows::{cell_text, writer},
    scale::{unit_alone, unit_named},
    unit::Measure,
};
use crate::{
    math::median,
    remark::{Code, Remarks},
};

/// Rows of properties that there are at least, unless a key comes again in a row.
const LEAST: usize = 3;
/// Steps that differ by less are the same.
const ALIKE: f64 = 0.01;

/// A row of properties: the key, and the cells.
struct Property<'a> {
    key: String,
    cells: Vec<&'a [u8]>,
}

/// The same numbers below one header; `None` unless the text is such a recording.
pub(super) fn as_table(text: &[u8], remarks: &mut Remarks) -> Option<Vec<u8>> {
    b"\t;,".iter().find_map(|separator| table(text, *separator, remarks))
}

fn table(text: &[u8], separator: u8, remarks: &mut Remarks) -> Option<Vec<u8>> {
    let lines: Vec<Vec<&[u8]>> = text
        .split(|byte| *byte == b'\n')
        .map(|line| line.split(|byte| *byte == separator).map(<[u8]>::trim_ascii).collect())
        .collect();
    let blank = |row: &[&[u8]]| row.iter().all(|cell| cell.is_empty());
    let numeric = |row: &[&[u8]]| {
        row.len() > 2 && !blank(row) && row.iter().all(|cell| cell.is_empty() || is_number(cell))
    };
    let first = lines.iter().position(|row| numeric(row))?;
    let end = lines[..first].iter().rposition(|row| !blank(row))? + 1;
    let start = lines[..end].iter().rposition(|row| blank(row)).map_or(0, |at| at + 1);
    let properties: Vec<Property<'_>> =
        lines[start..end].iter().map(|row| Property { key: cell_text(row[0]), cells: row.clone() }).collect();
    let (clocks, width) = clocks(&properties)?;
    // Below the first key stands a time: a word before a row of another table is none.
    if !lines[first..].iter().any(|row| row.first().is_some_and(|cell| is_number(cell))) {
        return None;
    }
    let names = names(&properties, &clocks, width, remarks);
    // A word may end the file.
    let last = lines.iter().rposition(|row| !blank(row)).filter(|last| !row_has_number(&lines[*last]));
    let rows: Vec<&Vec<&[u8]>> =
        lines[first..last.unwrap_or(lines.len())].iter().filter(|row| !blank(row)).collect();
    let time = time(&properties, &clocks, &rows);
    let header = (0..width).map(|at| if clocks.contains(&at) { time.clone() } else { names[at].clone() });
    let mut out = writer(Separator::Byte(b'\t'));
    out.write_record(header.map(String::into_bytes)).ok()?;
    for row in rows {
        let beyond = row.iter().skip(width).any(|cell| !cell.is_empty());
        let length = if beyond { row.len() } else { width };
        out.write_record(row.iter().copied().chain(std::iter::repeat(&[][..])).take(length)).ok()?;
    }
    out.into_inner().ok()
}

fn row_has_number(row: &[&[u8]]) -> bool {
    row.iter().any(|cell| is_number(cell))
}

fn is_number(cell: &[u8]) -> bool {
    number(cell, false).is_some() || number(cell, true).is_some()
}

/// The columns of times, at which all rows have their key, and how many columns there are.
fn clocks(properties: &[Property<'_>]) -> Option<(Vec<usize>, usize)> {
    let at = |one: &Property<'_>| -> Vec<usize> {
        let same = |at: &usize| cell_text(one.cells[*at]) == one.key;
        (0..one.cells.len()).filter(same).collect()
    };
    let first = properties.first()?;
    let clocks = at(first);
    let width = properties.iter().map(|one| one.cells.len()).max()?;
    // Some end each row with a separator.
    let trailing = properties.iter().all(|one| one.cells.len() < width || one.cells[width - 1].is_empty());
    let width = if trailing { width - 1 } else { width };
    let keyed = properties.iter().all(|one| !one.key.is_empty() && at(one) == clocks);
    let distinct =
        properties.iter().enumerate().all(|(k, one)| properties[..k].iter().all(|b| b.key != one.key));
    let counts =
        |one: &Property<'_>| (1..width).all(|at| one.cells.get(at).is_some_and(|cell| is_number(cell)));
    let enough = clocks.len() > 1 || properties.len() >= LEAST && properties.iter().any(counts);
    let owns = clocks.windows(2).all(|two| two[1] > two[0] + 1) && clocks.last()? + 1 < width;
    (keyed && distinct && enough && owns).then_some((clocks, width))
}

/// What keys say of the form of numbers, whose `REAL32` is no joint.
const TYPES: [&str; 3] = ["data-type", "datatype", "type"];

/// The names of the columns, by the row of names or else the one whose cells say most of joints, with their units.
fn names(properties: &[Property<'_>], clocks: &[usize], width: usize, remarks: &mut Remarks) -> Vec<String> {
    let of = |one: &Property<'_>| -> Vec<String> {
        (0..width).map(|at| one.cells.get(at).map_or_else(String::new, |cell| cell_text(cell))).collect()
    };
    let signals = || (0..width).filter(|at| !clocks.contains(at));
    let said = |one: &&Property<'_>| {
        let all = of(one);
        let count = signals().filter(|at| label(&all[*at], None).is_joint).count();
        let distinct = signals().map(|at| &all[at]).collect::<BTreeSet<_>>().len() == signals().count();
        (count > 0 && distinct && one.key.eq_ignore_ascii_case("name"), count > 0 && distinct, count)
    };
    let of_signal = |one: &&Property<'_>| !TYPES.iter().any(|key| one.key.eq_ignore_ascii_case(key));
    // The first of those that say as much.
    let best = properties.iter().rev().filter(of_signal).max_by_key(said);
    let mut names = best.map(of).unwrap_or_default();
    let scaled = properties.iter().filter(|one| {
        let word = one.key.to_lowercase();
        let plain = if word.contains("offset") { 0.0 } else { 1.0 };
        let other = |at: usize| {
            let value = one.cells.get(at).and_then(|cell| number(cell, false));
            value.is_some_and(|value| value.to_bits() != f64::to_bits(plain))
        };
        ["scalefactor", "offset"].contains(&word.as_str()) && signals().any(other)
    });
    for one in scaled {
        let message = format!(
            "row {:?} above the numbers gives other values than none; the numbers are read as they stand",
            one.key
        );
        remarks.add(Code::Guessed, 1, message);
    }
    if let Some(units) = properties.iter().find(|one| one.key.eq_ignore_ascii_case("unit")).map(of) {
        for at in signals() {
            if let Some(unit) = unit_alone(&units[at]) {
                names[at] = format!("{} [{}]", names[at], unit.name);
            }
        }
    }
    names
}

/// The header of times: in the unit that a key gives for the time between samples, if they are so far apart.
fn time(properties: &[Property<'_>], clocks: &[usize], rows: &[&Vec<&[u8]>]) -> String {
    const PLAIN: &str = "Time";
    let stated = properties.iter().find_map(|one| {
        let (_, unit) = one.key.strip_suffix([']', ')'])?.rsplit_once(['[', '('])?;
        let measure = unit_named(unit)?.measure;
        (measure == Measure::Time).then_some((unit, one))
    });
    let Some((unit, sampled)) = stated else { return PLAIN.to_owned() };
    let value = |cell: &[u8]| number(cell, false).or_else(|| number(cell, true));
    let alike = |clock: &usize| {
        let times: Vec<f64> = rows.iter().filter_map(|row| value(row.get(*clock)?)).collect();
        let steps: Vec<f64> =
            times.windows(2).map(|two| two[1] - two[0]).filter(|step| *step > 0.0).collect();
        let said = sampled.cells.get(clock + 1).and_then(|cell| value(cell));
        said.is_some_and(|said| !steps.is_empty() && (median(steps) / said - 1.0).abs() < ALIKE)
    };
    if clocks.iter().all(alike) { format!("{PLAIN} [{unit}]") } else { PLAIN.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> Option<(String, usize)> {
        let mut remarks = Remarks::default();
        let table = as_table(text.as_bytes(), &mut remarks)?;
        Some((String::from_utf8(table).unwrap(), remarks.as_slice().len()))
    }

    #[test]
    fn names_that_are_one_give_way_to_those_that_tell_signals_apart_and_units_may_name_their_quantity() {
        let text = "Name;SetPos;Name;ActPos;Name;SetPos;Name;ActPos\nUnit;deg (Angle);Unit;deg (Angle);Unit;deg (Angle);Unit;deg (Angle)\n\
                    SymbolName;Axes.Boom.SetPos;SymbolName;Axes.Boom.ActPos;SymbolName;Axes.Stick.SetPos;SymbolName;Axes.Stick.ActPos\n\
                    Port;501;Port;501;Port;501;Port;501\n\n0;1;0;1;0;1;0;1\n10;2;10;1;10;2;10;1\n";
        let (table, _) = of(text).unwrap();
        let header = table.lines().next().unwrap();
        assert!(
            header.contains("Axes.Boom.SetPos [deg]") && header.contains("Axes.Stick.ActPos [deg]"),
            "{header}"
        );
    }

    #[test]
    fn other_tables_are_left() {
        for text in [
            "t;q;r\n0;1;2\n", "a;1;b\nt;q;r\n0;1;2\n", "t;q;t;r\nt;q;s;r\n0;1;0;2\n", "Name;a;Name;b\n", "",
            "Name;a;Name\n0;1;2\n",
        ] {
            assert_eq!(of(text), None, "{text}");
        }
    }
}
