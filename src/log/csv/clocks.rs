//! Tables with a time column for each signal, as scopes and simulations write them, on one clock.

use std::{collections::BTreeSet, ops::Range};

use ::csv::ByteRecord;

use super::{
    CsvOptions, Role, clock,
    column::{named, pasted},
    dialect::Dialect,
    head::{Head, looked_at},
    label::Label,
    restarts::runs,
    rows::{Rows, writer},
    time::TimeSource,
    word::{Meaning, words},
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
    /// Which run of a recorder that was started again.
    run: usize,
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
    let (dialect, head) = looked_at(file, text, options)?;
    let (clocks, groups) = groups(&head, dialect, options)?;
    let first = groups.first()?;
    let Some(samples) = in_order(samples(text, &head, dialect, &groups), &groups) else {
        let names: Vec<String> = groups.iter().map(|group| pasted(group.time, &head.names)).collect();
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
    // Columns keep their numbers; those of the other times have no name and no cells.
    let name = |(column, name): (usize, &String)| {
        let other = clocks.contains(&column) && column != first.time;
        if other { Vec::new() } else { name.clone().into_bytes() }
    };
    out.write_record(head.names.iter().enumerate().map(name)).ok()?;
    for instant in samples.chunk_by(|a, b| a.run == b.run && a.ns >= b.ns && a.group < b.group) {
        let at = instant.first().and_then(time)?;
        let mut row = vec![&[][..]; head.names.len()];
        row[first.time] = &at;
        for sample in instant {
            for (cell, column) in sample.cells.iter().skip(1).zip(&groups[sample.group].columns) {
                row[*column] = cell;
            }
        }
        out.write_record(row).ok()?;
    }
    Some((out.into_inner().ok()?, dialect.rewritten(options)))
}

/// Whether there are several time columns that say different times, each of its own signals.
pub(super) fn are_several(file: &str, text: &[u8], options: &CsvOptions) -> bool {
    let of = || {
        let (dialect, head) = looked_at(file, text, options)?;
        groups(&head, dialect, options)
    };
    options.time.is_none() && options.rate_hz.is_none() && of().is_some()
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
                samples.push(Sample { run: 0, ns, group: k, cells });
            }
        }
    }
    samples
}

/// By run and time; `None` where the clocks share too little of it, one stands, or days turn over.
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
    if !spans.iter().all(|span| span[0] < span[1] && shares(*span, spans[0])) {
        return None;
    }
    let runs = runs(&samples.iter().map(|sample| (sample.group, sample.ns)).collect::<Vec<_>>());
    samples.iter_mut().zip(runs).for_each(|(sample, run)| sample.run = run);
    samples.sort_by_key(|sample| (sample.run, sample.ns, sample.group));
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

/// All columns of times, and those that are of signals that are wanted.
fn groups(head: &Head, dialect: Dialect, options: &CsvOptions) -> Option<(Vec<usize>, Vec<Group>)> {
    let labels = head.labels();
    let of = |time: &usize| clock::of_column(head, &labels, dialect, options, *time);
    // What goes up and down is no clock.
    let is_clock = |column: &usize| labels[*column].is_time && of(column).is_none_or(|found| found.steady());
    let mut times: Vec<usize> = (0..labels.len()).filter(is_clock).collect();
    // Beside a clock that rises, one that falls says what is left.
    let falls = |column: &usize| of(column).is_some_and(|found| found.falls());
    if !times.iter().all(falls) {
        times.retain(|column| !falls(column));
    }
    if !head.named || times.len() < 2 {
        return None;
    }
    let named = named(options, &head.names);
    let wanted = |column: usize| labels[column].is_joint || named.contains(&column);
    let one_name = times.iter().all(|time| head.names[*time] == head.names[times[0]]);
    let columns = by_name(head, &times, wanted).or_else(|| owned(&labels, &times, wanted, one_name))?;
    let sources: Vec<Option<TimeSource>> = times.iter().map(|time| Some(of(time)?.source)).collect();
    let ns = |row: &Vec<Vec<u8>>, source: &Option<TimeSource>| {
        let cell = |column: usize| row.get(column).map_or(&[][..], Vec::as_slice);
        source.as_ref()?.ns(0, cell, dialect.decimal_comma)
    };
    let differs = |row: &Vec<Vec<u8>>| {
        let first = ns(row, &sources[0]);
        sources.iter().map(|source| ns(row, source)).any(|other| match (first, other) {
            (Some(a), Some(b)) => a.abs_diff(b) > SAME_NS.unsigned_abs(),
            (a, b) => a != b,
        })
    };
    if !head.sample.iter().any(differs) {
        return None;
    }
    // The times of signals that nobody wants add no rows.
    let all = times.iter().copied().zip(sources).zip(columns);
    let groups = all.filter(|(_, columns)| columns.iter().any(|column| wanted(*column)));
    let groups: Vec<Group> = groups
        .map(|((time, source), columns)| Some(Group { time, source: source?, columns }))
        .collect::<Option<_>>()?;
    let numbers = |group: &Group| matches!(group.source, TimeSource::Number { .. });
    let one_form =
        groups.iter().all(numbers) || groups.iter().all(|group| alike(&group.source, &groups[0].source));
    one_form.then_some((times, groups))
}

/// The columns of each time where headers tell it: `boom_act_SourceTimestamp` is of `boom_act`, and of two such the first. A time of the row
/// has none.
fn by_name(head: &Head, times: &[usize], wanted: impl Fn(usize) -> bool) -> Option<Vec<Vec<usize>>> {
    let plain = |column: usize| head.names[column].to_lowercase();
    let signals: Vec<String> = times.iter().map(|time| signal(&plain(*time)).to_owned()).collect();
    let mut found = vec![Vec::new(); times.len()];
    for column in (0..head.names.len()).filter(|column| wanted(*column) && !times.contains(column)) {
        let name = plain(column);
        let is_of = |signal: &str| {
            let rest = name.strip_prefix(signal);
            !signal.is_empty() && rest.is_some_and(|rest| !rest.starts_with(char::is_alphanumeric))
        };
        let own = signals.iter().enumerate().rev().filter(|(_, signal)| is_of(signal));
        found[own.max_by_key(|(_, signal)| signal.len())?.0].push(column);
    }
    (found.iter().filter(|columns| !columns.is_empty()).count() > 1).then_some(found)
}

/// What a header in small letters says before its last words, which are of a time; nothing where they are not.
fn signal(header: &str) -> &str {
    const OF_TIMES: [&str; 4] = ["source", "server", "utc", "local"];
    let mut rest = header;
    while let Some(last) = words(rest).last() {
        let of_time = last.meaning == Meaning::Time || last.text.ends_with("timestamp");
        if !of_time && (rest == header || !OF_TIMES.contains(&last.text)) {
            break;
        }
        let ends = rest.rfind(last.text).unwrap_or_default();
        rest = rest[..ends].trim_end_matches(['_', ' ', '.', '-', '/', ':']);
    }
    if rest == header { "" } else { rest }
}

/// The columns of each time: those behind it, those before it, or those of its side. A time may have none that is wanted,
/// if others do or, of times of one name, another.
fn owned(
    labels: &[Label],
    times: &[usize],
    wanted: impl Fn(usize) -> bool,
    one_name: bool,
) -> Option<Vec<Vec<usize>>> {
    let wants = |mut range: Range<usize>| range.any(&wanted);
    let (first, last) = (*times.first()?, *times.last()?);
    let between = |edges: Vec<usize>| -> Option<Vec<Vec<usize>>> {
        let all: Vec<Vec<usize>> = edges
            .windows(2)
            .map(|pair| (pair[0]..pair[1]).filter(|column| !times.contains(column)).collect())
            .collect();
        let owners = all.iter().filter(|columns| columns.iter().any(|column| wanted(*column))).count();
        let enough = owners > 1 || owners == 1 && one_name;
        (enough && all.iter().all(|columns| !columns.is_empty())).then_some(all)
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
    let found = if wants(0..first) { None } else { behind() };
    found.or_else(|| if wants(last..labels.len()) { None } else { before() }).or_else(by_side)
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
        let expected = "t_set_s,boom_set_deg,,boom_act_deg\n0.0,1,,\n0.05,,,2\n0.1,3,,4\n0.2,5,,\n";
        assert_eq!(of(text).as_deref(), Some(expected));
    }

    #[test]
    fn what_is_left_of_a_time_is_no_clock() {
        let row = |k: u32| format!("{0}.0,{0},{1}.5,{0},{0}\n", k, 60 - k);
        let rows: String = (0..40).map(row).collect();
        assert_eq!(of(&format!("timestamp_s,action_J9,time_remaining_s,target_J1,actual_J1\n{rows}")), None);
    }

    #[test]
    fn times_may_stand_behind_their_signals_or_say_their_side_and_have_units_of_their_own() {
        let expected = "t_set_s,boom_set_deg,,boom_act_deg\n0.000000,1,,\n0.050000,,,2\n0.100000,3,,4\n";
        let text = "t_set_s,boom_set_deg,t_act_ms,boom_act_deg\n0.0,1,50,2\n0.1,3,100,4\n";
        assert_eq!(of(text).as_deref(), Some(expected));
        let expected = "boom_planned_deg,planned_time_s,boom_measured_deg,\n1,0.0,,\n,0.05,2,\n3,0.1,4,\n";
        let text =
            "boom_planned_deg,planned_time_s,boom_measured_deg,measured_time_s\n1,0.0,2,0.05\n3,0.1,4,0.1\n";
        assert_eq!(of(text).as_deref(), Some(expected));
        let text =
            "planned_time_s,measured_time_s,boom_planned_deg,boom_measured_deg\n0.0,0.05,1,2\n0.1,0.1,3,4\n";
        let expected = "planned_time_s,,boom_planned_deg,boom_measured_deg\n0.0,,1,\n0.05,,,2\n0.1,,3,4\n";
        assert_eq!(of(text).as_deref(), Some(expected));
        let day = "Time;boom_set_deg;Time;boom_act_deg\n05.03.2026 09:15:00,000;1;05.03.2026 09:15:00,250;2\n\
                   05.03.2026 09:15:01,000;3;05.03.2026 09:15:01,250;4\n";
        let rows = "05.03.2026 09:15:00,000;1;;\n05.03.2026 09:15:00,250;;;2\n05.03.2026 09:15:01,000;3;;\n\
                    05.03.2026 09:15:01,250;;;4\n";
        assert_eq!(of(day), Some(format!("Time;boom_set_deg;;boom_act_deg\n{rows}")));
    }

    #[test]
    fn a_time_is_of_the_signal_that_its_header_names_whatever_stands_beside_it() {
        let text = "Time,boom_set_deg,boom_set_deg_SourceTimestamp,boom_set_deg_StatusCode,boom_act_deg,boom_act_deg_SourceTimestamp\n\
                    0.3,1,0.0,0,2,0.05\n0.4,3,0.1,0,4,0.1\n";
        let expected = ",boom_set_deg,boom_set_deg_SourceTimestamp,boom_set_deg_StatusCode,boom_act_deg,\n\
                        ,1,0.0,,,\n,,0.05,,2,\n,3,0.1,,4,\n";
        assert_eq!(of(text).as_deref(), Some(expected));
    }

    #[test]
    fn a_clock_of_a_signal_that_is_no_joint_leaves_the_joints_to_their_own() {
        let text =
            "Time,boom_set_deg,Time,boom_act_deg,Time,Current\n0.0,1,0.05,2,0.0,7\n0.1,3,0.1,4,0.01,8\n";
        let kept = "Time,boom_set_deg,,boom_act_deg,,Current\n0.0,1,,,,\n0.05,,,2,,\n0.1,3,,4,,\n";
        assert_eq!(of(text).as_deref(), Some(kept));
        let text = "Time,Current,Time,boom_set_deg,boom_act_deg\n0.0,7,0.0,1,2\n0.01,8,0.1,3,4\n";
        let kept = ",Current,Time,boom_set_deg,boom_act_deg\n,,0.0,1,2\n,,0.1,3,4\n";
        assert_eq!(of(text).as_deref(), Some(kept));
        // Of clocks with names of their own nobody knows.
        assert_eq!(of(&text.replacen("Time", "log_time", 1)), None);
        let named = CsvOptions {
            interfaces: [("amps".to_owned(), vec![("boom".to_owned(), "#2".to_owned())])].into(),
            ..CsvOptions::default()
        };
        let (both, _) = joined("a.csv", text.as_bytes(), &named, &mut Remarks::default()).unwrap();
        assert_eq!(String::from_utf8(both).unwrap().lines().nth(2), Some("0.01,8,,,"));
    }

    #[test]
    fn one_clock_written_twice_or_in_parts_is_left() {
        assert_eq!(of("t_s,boom_set_deg,t_s,boom_act_deg\n0.0,1,0.0,2\n0.1,3,0.1,4\n"), None);
        assert_eq!(of("t_s,boom_set_deg,t_run_s,boom_act_deg\n0.0,1,0.05,2\n0.1,3,0.05,4\n"), None);
        assert_eq!(of("sec,nanosec,boom_set_deg,boom_act_deg\n0,5,1,2\n0,6,3,4\n"), None);
        assert_eq!(of("t_s,boom_set_deg,boom_act_deg\n0,1,2\n1,3,4\n"), None);
    }
}
