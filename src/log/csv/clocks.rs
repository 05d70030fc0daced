//! Tables with a time column for each signal, as scopes and simulations write them, on one clock.

use std::{collections::BTreeSet, ops::Range};

use ::csv::ByteRecord;

use super::{
    CsvOptions, Role, clock,
    dialect::{Dialect, detect},
    head::{Head, read_head},
    label::{Label, label},
    rows::{Rows, writer},
    time::TimeSource,
};
use crate::remark::{Code, Remarks};

/// The shorter of two clocks shares so much of its time with the other one, or they count from different instants.
const SHARED: f64 = 0.5;
/// Times that differ by less are written with fewer digits, ns.
const SAME_NS: i64 = 500_000;

/// A column of times, and the columns that it is of.
struct Group {
    time: usize,
    source: TimeSource,
    columns: Vec<usize>,
}

/// The cells of a row that are of one clock.
struct Sample {
    ns: i64,
    group: usize,
    cells: ByteRecord,
}

/// The same samples with one time column, a row an instant, and how that is read; `None` unless several time columns, each of its own signals,
/// say different times.
pub(super) fn joined(
    file: &str,
    text: &[u8],
    options: &CsvOptions,
    remarks: &mut Remarks,
) -> Option<(Vec<u8>, CsvOptions)> {
    if options.time.is_some() || options.rate_hz.is_some() {
        return None;
    }
    let dialect = detect(file, text, options).ok()?;
    let head = read_head(text, dialect, &mut Remarks::default());
    let groups = groups(&head, dialect, options)?;
    let first = groups.first()?;
    let Some(samples) = in_order(samples(text, &head, dialect, &groups), &groups) else {
        let names: Vec<&str> = groups.iter().map(|group| head.names[group.time].as_str()).collect();
        let message = format!(
            "columns {} tell different times that have little in common: each row is read at the first one, unless --time \
             names another",
            names.join(", ")
        );
        remarks.add(Code::Ambiguous, 1, message);
        return None;
    };
    let raw = groups.iter().all(|group| alike(&group.source, &first.source));
    let time = |sample: &Sample| {
        let own = || Some(sample.cells.get(0)?.to_vec());
        if raw { own() } else { in_unit(sample.ns, &first.source, dialect.decimal_comma) }
    };
    let mut out = writer(dialect.separator);
    let columns = || groups.iter().flat_map(|group| group.columns.iter().copied());
    let names = std::iter::once(first.time).chain(columns()).map(|column| head.names[column].as_bytes());
    out.write_record(names).ok()?;
    for instant in samples.chunk_by(|a, b| a.ns >= b.ns && a.group < b.group) {
        let at = instant.first().and_then(time)?;
        let mut row = vec![at.as_slice()];
        for (k, group) in groups.iter().enumerate() {
            let own = instant.iter().find(|sample| sample.group == k).map(|sample| &sample.cells);
            row.extend(
                (1..=group.columns.len()).map(|at| own.and_then(|cells| cells.get(at)).unwrap_or_default()),
            );
        }
        out.write_record(row).ok()?;
    }
    Some((out.into_inner().ok()?, dialect.rewritten(options)))
}

/// Every sample of the table, row by row.
fn samples(text: &[u8], head: &Head, dialect: Dialect, groups: &[Group]) -> Vec<Sample> {
    let mut samples = Vec::new();
    let mut rows = Rows::new(text, dialect.separator);
    let mut record = ByteRecord::new();
    while let Some(line) = rows.next(&mut record) {
        if line < head.first_line {
            continue;
        }
        let cell = |column: usize| record.get(column).unwrap_or_default();
        for (k, group) in groups.iter().enumerate() {
            if let Some(ns) = group.source.ns(0, cell, dialect.decimal_comma) {
                let cells =
                    std::iter::once(group.time).chain(group.columns.iter().copied()).map(cell).collect();
                samples.push(Sample { ns, group: k, cells });
            }
        }
    }
    samples
}

/// By time; `None` where the clocks share too little of it, or days turn over.
fn in_order(mut samples: Vec<Sample>, groups: &[Group]) -> Option<Vec<Sample>> {
    let mut spans: Vec<Option<[i64; 2]>> = vec![None; groups.len()];
    for sample in &samples {
        let [from, to] = spans[sample.group].get_or_insert([sample.ns; 2]);
        let dated = matches!(groups[sample.group].source, TimeSource::Date { .. });
        if dated && sample.ns < *to {
            return None;
        }
        (*from, *to) = ((*from).min(sample.ns), (*to).max(sample.ns));
    }
    let spans: Vec<[i64; 2]> = spans.into_iter().collect::<Option<_>>()?;
    let long = |[from, to]: [i64; 2]| to.saturating_sub(from) as f64;
    let shares =
        |a: [i64; 2], b: [i64; 2]| long([a[0].max(b[0]), a[1].min(b[1])]) >= SHARED * long(a).min(long(b));
    if !spans.iter().all(|span| shares(*span, spans[0])) {
        return None;
    }
    samples.sort_by_key(|sample| (sample.ns, sample.group));
    Some(samples)
}

/// Whether cells of one clock can stand in the column of the other.
fn alike(a: &TimeSource, b: &TimeSource) -> bool {
    match (a, b) {
        (TimeSource::Number { unit: a, .. }, TimeSource::Number { unit: b, .. }) => a.name == b.name,
        (TimeSource::Date { form: a, .. }, TimeSource::Date { form: b, .. }) => a.name == b.name,
        _ => false,
    }
}

/// A time as a cell of a column of numbers.
fn in_unit(ns: i64, source: &TimeSource, comma: bool) -> Option<Vec<u8>> {
    let TimeSource::Number { unit, .. } = source else { return None };
    let value = (i128::from(ns) - unit.zero_ns()) as f64 / unit.factor;
    let text = format!("{value:.6}");
    Some(if comma { text.replace('.', ",") } else { text }.into_bytes())
}

fn groups(head: &Head, dialect: Dialect, options: &CsvOptions) -> Option<Vec<Group>> {
    let below = |column: usize| head.units.as_ref().and_then(|units| units.get(column)).map(String::as_str);
    let labels: Vec<Label> =
        head.names.iter().enumerate().map(|(column, name)| label(name, below(column))).collect();
    let of = |time: &usize| clock::of_column(head, &labels, dialect, options, *time);
    // What goes up and down is no clock.
    let is_clock = |column: &usize| labels[*column].is_time && of(column).is_none_or(|found| found.steady);
    let times: Vec<usize> = (0..labels.len()).filter(is_clock).collect();
    if !head.named || times.len() < 2 {
        return None;
    }
    let columns = owned(&labels, &times)?;
    let sources: Vec<TimeSource> = times.iter().map(|time| Some(of(time)?.source)).collect::<Option<_>>()?;
    let numbers = |source: &TimeSource| matches!(source, TimeSource::Number { .. });
    let one_form = sources.iter().all(numbers) || sources.iter().all(|source| alike(source, &sources[0]));
    let ns = |row: &Vec<Vec<u8>>, source: &TimeSource| {
        source.ns(0, |column| row.get(column).map_or(&[][..], Vec::as_slice), dialect.decimal_comma)
    };
    let differs = |row: &Vec<Vec<u8>>| {
        let first = ns(row, &sources[0]);
        sources.iter().map(|source| ns(row, source)).any(|other| match (first, other) {
            (Some(a), Some(b)) => a.abs_diff(b) > SAME_NS.unsigned_abs(),
            (a, b) => a != b,
        })
    };
    let group = |((time, source), columns)| Group { time, source, columns };
    (one_form && head.sample.iter().any(differs))
        .then(|| times.into_iter().zip(sources).zip(columns).map(group).collect())
}

/// The columns of each time: those behind it, those before it, or those of its side.
fn owned(labels: &[Label], times: &[usize]) -> Option<Vec<Vec<usize>>> {
    let joints = |range: Range<usize>| labels[range].iter().any(|label| label.is_joint);
    let (first, last) = (*times.first()?, *times.last()?);
    let between = |edges: Vec<usize>| -> Option<Vec<Vec<usize>>> {
        let all: Vec<Vec<usize>> = edges
            .windows(2)
            .map(|pair| (pair[0]..pair[1]).filter(|column| !times.contains(column)).collect())
            .collect();
        let owns = |columns: &Vec<usize>| columns.iter().any(|column| labels[*column].is_joint);
        all.iter().all(owns).then_some(all)
    };
    let behind = || between(times.iter().copied().chain([labels.len()]).collect());
    let before = || between(std::iter::once(0).chain(times.iter().map(|time| time + 1)).collect());
    let by_side = || {
        let side = |column: usize| labels[column].role;
        let roles: BTreeSet<Role> = times.iter().filter_map(|time| side(*time)).collect();
        let signals: Vec<usize> =
            (0..labels.len()).filter(|column| labels[*column].is_joint && !times.contains(column)).collect();
        let told = signals.iter().all(|column| side(*column).is_some_and(|role| roles.contains(&role)));
        let of = |time: &usize| -> Vec<usize> {
            signals.iter().copied().filter(|column| side(*column) == side(*time)).collect()
        };
        (roles.len() == times.len() && told).then(|| times.iter().map(of).collect::<Vec<_>>())
    };
    let found = if joints(0..first) { None } else { behind() };
    found.or_else(|| if joints(last..labels.len()) { None } else { before() }).or_else(by_side)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> Option<String> {
        let (joined, _) = joined("a.csv", text.as_bytes(), &CsvOptions::default(), &mut Remarks::default())?;
        Some(String::from_utf8(joined).unwrap())
    }

    #[test]
    fn signals_with_times_of_their_own_come_onto_one_clock() {
        let text = "t_set_s,boom_set_deg,t_act_s,boom_act_deg\n0.0,1,0.05,2\n0.1,3,0.1,4\n0.2,5,,\n";
        let expected = "t_set_s,boom_set_deg,boom_act_deg\n0.0,1,\n0.05,,2\n0.1,3,4\n0.2,5,\n";
        assert_eq!(of(text).as_deref(), Some(expected));
    }

    #[test]
    fn times_may_stand_behind_their_signals_or_say_their_side_and_have_units_of_their_own() {
        let expected = "t_set_s,boom_set_deg,boom_act_deg\n0.000000,1,\n0.050000,,2\n0.100000,3,4\n";
        let text = "t_set_s,boom_set_deg,t_act_ms,boom_act_deg\n0.0,1,50,2\n0.1,3,100,4\n";
        assert_eq!(of(text).as_deref(), Some(expected));
        let expected = "planned_time_s,boom_planned_deg,boom_measured_deg\n0.0,1,\n0.05,,2\n0.1,3,4\n";
        let text =
            "boom_planned_deg,planned_time_s,boom_measured_deg,measured_time_s\n1,0.0,2,0.05\n3,0.1,4,0.1\n";
        assert_eq!(of(text).as_deref(), Some(expected));
        let text =
            "planned_time_s,measured_time_s,boom_planned_deg,boom_measured_deg\n0.0,0.05,1,2\n0.1,0.1,3,4\n";
        assert_eq!(of(text).as_deref(), Some(expected));
        let day = "Time;boom_set_deg;Time;boom_act_deg\n05.03.2026 09:15:00,000;1;05.03.2026 09:15:00,250;2\n\
                   05.03.2026 09:15:01,000;3;05.03.2026 09:15:01,250;4\n";
        let rows = "05.03.2026 09:15:00,000;1;\n05.03.2026 09:15:00,250;;2\n05.03.2026 09:15:01,000;3;\n\
                    05.03.2026 09:15:01,250;;4\n";
        assert_eq!(of(day), Some(format!("Time;boom_set_deg;boom_act_deg\n{rows}")));
    }

    #[test]
    fn one_clock_written_twice_or_in_parts_is_left() {
        assert_eq!(of("t_s,boom_set_deg,t_s,boom_act_deg\n0.0,1,0.0,2\n0.1,3,0.1,4\n"), None);
        assert_eq!(of("sec,nanosec,boom_set_deg,boom_act_deg\n0,5,1,2\n0,6,3,4\n"), None);
        assert_eq!(of("t_s,boom_set_deg,boom_act_deg\n0,1,2\n1,3,4\n"), None);
    }
}
