//! Recordings of a controller's oscilloscope: above the numbers stand rows of properties, in which a key stands before
//! each signal, or before the signals of a clock, and below it the times of that clock.

use std::{borrow::Cow, collections::BTreeSet};

use super::{
    Separator,
    label::label,
    number::number,
    rows::{cell_text, writer},
    scale::{unit_alone, unit_named},
    started::Started,
    unit::{Measure, Unit},
};
use crate::{
    math::median,
    remark::{Code, Remarks},
    units::whole_ns,
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
        row.len() > 1 && !blank(row) && row.iter().all(|cell| cell.is_empty() || is_number(cell))
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
    let sampled = sampled(&properties);
    let counted = counted(sampled, &clocks, &rows, width);
    let time = |row: usize| counted.map(|step| Cow::Owned((step * row as f64).to_string().into_bytes()));
    let rows: Vec<Vec<Cow<'_, [u8]>>> = rows
        .iter()
        .enumerate()
        .map(|(at, row)| time(at).into_iter().chain(row.iter().map(|cell| Cow::Borrowed(*cell))).collect())
        .collect();
    let unit = sampled.filter(|sampled| counted.is_some() || sampled.are_steps(&clocks, &rows));
    let started = lines[..start].iter().find(|row| row[0].starts_with(b"Starttime"));
    let started = unit.zip(started.and_then(|row| Started::of_filetime(row.get(1)?)));
    let time = match (unit, started) {
        (Some(sampled), None) => format!("{PLAIN} [{}]", sampled.unit.name),
        _ => PLAIN.to_owned(),
    };
    let header = (0..width).map(|at| if clocks.contains(&at) { time.clone() } else { names[at].clone() });
    let mut out = writer(Separator::Byte(b'\t'));
    out.write_record(header.map(String::into_bytes)).ok()?;
    for row in rows {
        let beyond = row.iter().skip(width).any(|cell| !cell.is_empty());
        let length = if beyond { row.len() } else { width };
        for at in 0..length {
            let cell = row.get(at).map_or(&[][..], |cell| cell);
            let instant = started.filter(|_| clocks.contains(&at)).and_then(|(sampled, started)| {
                let unit_ns = whole_ns(sampled.unit.factor)?;
                started.at(cell, false, unit_ns).or_else(|| started.at(cell, true, unit_ns))
            });
            out.write_field(instant.as_deref().unwrap_or(cell)).ok()?;
        }
        out.write_record(None::<&[u8]>).ok()?;
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
            let value = one.cells.get(at).and_then(|cell| value(cell));
            value.is_some_and(|value| value.to_bits() != f64::to_bits(plain))
        };
        ["scalefactor", "offset"].contains(&word.trim_start_matches("unit ")) && signals().any(other)
    });
    for one in scaled {
        let message = format!(
            "row {:?} above the numbers scales or moves them, and no row says whether that is done: they are read as they stand; else say \
             --planned JOINT=FACTOR*COLUMN and --measured",
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

/// The header of times.
const PLAIN: &str = "Time";

/// The row of the time between samples, and its unit.
#[derive(Clone, Copy)]
struct Sampled<'a> {
    cells: &'a [&'a [u8]],
    unit: Unit,
}

fn sampled<'a>(properties: &'a [Property<'_>]) -> Option<Sampled<'a>> {
    properties.iter().find_map(|one| {
        let (_, unit) = one.key.strip_suffix([']', ')'])?.rsplit_once(['[', '('])?;
        let unit = unit_named(unit).filter(|unit| unit.measure == Measure::Time)?;
        Some(Sampled { cells: &one.cells, unit })
    })
}

fn value(cell: &[u8]) -> Option<f64> {
    number(cell, false).or_else(|| number(cell, true))
}

impl Sampled<'_> {
    /// Whether the times of each clock are so far apart.
    fn are_steps(self, clocks: &[usize], rows: &[Vec<Cow<'_, [u8]>>]) -> bool {
        clocks.iter().all(|clock| {
            let times: Vec<f64> = rows.iter().filter_map(|row| value(row.get(*clock)?)).collect();
            let steps: Vec<f64> =
                times.windows(2).map(|two| two[1] - two[0]).filter(|step| *step > 0.0).collect();
            let said = self.cells.get(clock + 1).and_then(|cell| value(cell));
            said.is_some_and(|said| !steps.is_empty() && (median(steps) / said - 1.0).abs() < ALIKE)
        })
    }
}

/// The time between rows that have none of their own, which lack the first column: that of all signals.
fn counted(
    sampled: Option<Sampled<'_>>,
    clocks: &[usize],
    rows: &[&Vec<&[u8]>],
    width: usize,
) -> Option<f64> {
    let cells = sampled?.cells.get(1..)?;
    let first = cells.first().and_then(|cell| value(cell)).filter(|step| step.is_finite() && *step > 0.0)?;
    let lack = clocks == [0] && rows.iter().all(|row| row.len() + 1 == width);
    (lack && cells.iter().all(|cell| cell.is_empty() || *cell == cells[0])).then_some(first)
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
    fn rows_without_a_time_come_as_often_as_their_samples_from_the_start_on() {
        let text = "Starttime of export;133944808000000000;Sunday\n\nName;SetPos_1;ActPos_1\nSampleTime[ms];20;20\n\
                    Port;851;851\n\n0,5;0,25\n1,5;0,5\n2;1\n";
        let [mut undated, dated] =
            [&text[text.find("Name").unwrap()..], text].map(|text| of(text).unwrap().0);
        assert!(undated.starts_with("Time [ms]\tSetPos_1\tActPos_1\n0\t0,5\t0,25\n20\t1,5"), "{undated}");
        undated = dated.lines().nth(2).unwrap_or_default().to_owned();
        assert_eq!(undated, "2025-06-15 17:06:40.020000000Z\t1,5\t0,5");
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
