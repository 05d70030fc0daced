//! Tables with a time column for each signal, as scopes and simulations write them, on one clock.

use std::ops::Range;

use ::csv::ByteRecord;

use super::{
    CsvOptions,
    dialect::{Dialect, detect},
    head::{Head, read_head},
    label::label,
    number::number,
    rows::{Rows, writer},
};
use crate::remark::Remarks;

/// Clocks begin no farther apart than so many times what the first rows span.
const FARTHEST: f64 = 5.0;

/// A column of times, and the columns that it is of.
struct Group {
    time: usize,
    columns: Range<usize>,
}

/// The same samples with one time column, a row an instant; `None` unless several time columns, each before its own signals,
/// say different times.
pub(super) fn joined(file: &str, text: &[u8], options: &CsvOptions) -> Option<Vec<u8>> {
    if options.time.is_some() || options.rate_hz.is_some() {
        return None;
    }
    let dialect = detect(file, text, options).ok()?;
    let head = read_head(text, dialect, &mut Remarks::default());
    let groups = groups(&head, dialect)?;
    let mut samples: Vec<(f64, usize, ByteRecord)> = Vec::new();
    let mut rows = Rows::new(text, dialect.separator);
    let mut record = ByteRecord::new();
    while let Some(line) = rows.next(&mut record) {
        if line < head.first_line {
            continue;
        }
        for (k, group) in groups.iter().enumerate() {
            let time = record.get(group.time).and_then(|cell| number(cell, dialect.decimal_comma));
            if let Some(time) = time.filter(|time| time.is_finite()) {
                let cells = std::iter::once(group.time).chain(group.columns.clone());
                samples.push((time, k, cells.map(|column| record.get(column).unwrap_or_default()).collect()));
            }
        }
    }
    samples.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let mut out = writer(dialect.separator);
    let first = groups.first()?;
    let columns = || groups.iter().flat_map(|group| group.columns.clone());
    let names = std::iter::once(first.time).chain(columns()).map(|column| head.names[column].as_bytes());
    out.write_record(names).ok()?;
    for instant in samples.chunk_by(|a, b| a.0 >= b.0 && a.1 < b.1) {
        let time = instant.first().and_then(|(_, _, cells)| cells.get(0)).unwrap_or_default();
        let mut row = vec![time];
        for (k, group) in groups.iter().enumerate() {
            let own = instant.iter().find(|(_, of, _)| *of == k).map(|(_, _, cells)| cells);
            row.extend(
                (1..=group.columns.len()).map(|at| own.and_then(|cells| cells.get(at)).unwrap_or_default()),
            );
        }
        out.write_record(row).ok()?;
    }
    out.into_inner().ok()
}

fn groups(head: &Head, dialect: Dialect) -> Option<Vec<Group>> {
    let below = |column: usize| head.units.as_ref().and_then(|units| units.get(column)).map(String::as_str);
    let labels: Vec<_> =
        head.names.iter().enumerate().map(|(column, name)| label(name, below(column))).collect();
    let times: Vec<usize> = (0..labels.len()).filter(|column| labels[*column].is_time).collect();
    let unit = |column: usize| labels[column].unit.map(|unit| unit.name);
    let [first, _, ..] = times[..] else { return None };
    let ends = times.iter().skip(1).copied().chain([labels.len()]);
    let groups: Vec<Group> =
        times.iter().zip(ends).map(|(time, end)| Group { time: *time, columns: time + 1..end }).collect();
    let owns = |group: &Group| group.columns.clone().any(|column| labels[column].is_joint);
    let alike = times.iter().all(|time| unit(*time) == unit(first));
    if !head.named || !alike || !groups.iter().all(owns) || labels[..first].iter().any(|label| label.is_joint)
    {
        return None;
    }
    let time = |row: &[Vec<u8>], column: usize| number(row.get(column)?, dialect.decimal_comma);
    let differs = |row: &Vec<Vec<u8>>| {
        times.iter().any(|column| Some(time(row, *column)).flatten() != Some(time(row, first)).flatten())
    };
    // Clocks that count from elsewhere are other clocks of the same rows.
    let of = |column: usize| head.sample.iter().filter_map(move |row| time(row, column));
    let [from, to] = crate::math::range(of(first));
    let near = |column: &usize| {
        of(*column).next().is_some_and(|start| (start - from).abs() <= FARTHEST * (to - from))
    };
    (times.iter().all(near) && head.sample.iter().any(differs)).then_some(groups)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> Option<String> {
        let joined = joined("a.csv", text.as_bytes(), &CsvOptions::default())?;
        Some(String::from_utf8(joined).unwrap())
    }

    #[test]
    fn signals_with_times_of_their_own_come_onto_one_clock() {
        let text = "t_set_s,boom_set_deg,t_act_s,boom_act_deg\n0.0,1,0.05,2\n0.1,3,0.1,4\n0.2,5,,\n";
        let expected = "t_set_s,boom_set_deg,boom_act_deg\n0.0,1,\n0.05,,2\n0.1,3,4\n0.2,5,\n";
        assert_eq!(of(text).as_deref(), Some(expected));
    }

    #[test]
    fn one_clock_written_twice_or_in_parts_is_left() {
        assert_eq!(of("t_s,boom_set_deg,t_s,boom_act_deg\n0.0,1,0.0,2\n0.1,3,0.1,4\n"), None);
        assert_eq!(of("sec,nanosec,boom_set_deg,boom_act_deg\n0,5,1,2\n0,6,3,4\n"), None);
        assert_eq!(of("t_s,boom_set_deg,boom_act_deg\n0,1,2\n1,3,4\n"), None);
    }
}
