//! Rows that were written twice, time and all: each counts once, before anything is judged by its stamps.

use ::csv::ByteRecord;

use super::{
    CsvOptions,
    column::find,
    head::{Head, looked_at},
    rows::Rows,
};
use crate::remark::{Code, Remarks};

/// Fewer repeats than the first are chance, unless every row has one; fewer than the second are it in any case.
const FEWEST: usize = 8;
const LEAST: usize = 3;

/// Share of rows with the time of the row before that repeat all of it, where rows were written twice, at instants at which values change.
/// Those of a clock that is coarser than the rows do not, and at rest both do.
const WRITTEN_TWICE: f64 = 0.99;

/// The table without the rows that repeat the row before; `None` where they were not written twice.
pub(super) fn once(file: &str, text: &[u8], options: &CsvOptions, remarks: &mut Remarks) -> Option<Vec<u8>> {
    let says = |line: &&[u8]| !line.trim_ascii().is_empty() && !line.starts_with(b"#");
    let lines = || text.split(|byte| *byte == b'\n').map(<[u8]>::trim_ascii_end).filter(says);
    let same = lines().zip(lines().skip(1)).filter(|(one, next)| one == next).count();
    let enough = same >= FEWEST || same >= LEAST && 2 * (same + 1) >= lines().count();
    if !enough || options.rate_hz.is_some() {
        return None;
    }
    let repeats = repeats(file, text, options)?;
    let (mut kept, mut before) = (Vec::with_capacity(text.len()), &[][..]);
    let mut left_out = 0;
    for (number, line) in (1..).zip(text.split_inclusive(|byte| *byte == b'\n')) {
        let cells = line.trim_ascii_end();
        if cells == before && repeats.binary_search(&number).is_ok() {
            left_out += 1;
            continue;
        }
        kept.extend_from_slice(line);
        before = if says(&cells) { cells } else { before };
    }
    let message = "rows that repeat the row before, time and all: they were written twice; left out";
    remarks.add(Code::DuplicateStamp, left_out, message);
    Some(kept)
}

/// Lines of rows that repeat the row before, if nearly all do that have its time.
fn repeats(file: &str, text: &[u8], options: &CsvOptions) -> Option<Vec<u64>> {
    let (dialect, head) = looked_at(file, text, options)?;
    let times = times(&head, options);
    let values: Vec<usize> = (0..head.names.len()).filter(|at| !times.contains(at)).collect();
    let (mut rows, mut repeats) = (Rows::new(text, dialect.separator), Vec::new());
    let (mut record, mut before) = (ByteRecord::new(), ByteRecord::new());
    let (mut changes, mut twice, mut again) = (false, 0_usize, 0_usize);
    while let Some(line) = rows.next(&mut record) {
        if line > head.first_line {
            let same = record == before;
            if same || times.iter().all(|at| record.get(*at) == before.get(*at)) {
                changes |= !same;
                again += usize::from(changes);
                twice += usize::from(changes && same);
            } else {
                changes = values.is_empty() || values.iter().any(|at| record.get(*at) != before.get(*at));
            }
            repeats.extend(same.then_some(line));
        }
        std::mem::swap(&mut record, &mut before);
    }
    (twice > 0 && twice as f64 >= WRITTEN_TWICE * again as f64).then_some(repeats)
}

/// The columns that say when a row was; all of a table that calls none so.
fn times(head: &Head, options: &CsvOptions) -> Vec<usize> {
    let given = options.time.as_deref().and_then(|name| find(name, "--time", &head.names).ok());
    let labels = head.labels();
    let named = (0..labels.len()).filter(|at| given.map_or(labels[*at].is_time, |given| given == *at));
    let named: Vec<usize> = named.collect();
    if named.is_empty() { (0..labels.len()).collect() } else { named }
}

#[cfg(test)]
mod tests {
    use super::{super::read_csv_bytes, *};

    fn read(rows: impl Fn(u32) -> String) -> (Vec<i64>, Vec<Code>) {
        let text: String = (0..40).map(rows).collect();
        let text = format!("t_s,J1_target_deg,J1_actual_deg\n{text}");
        let run = read_csv_bytes("a.csv", text.as_bytes(), &CsvOptions::default()).unwrap();
        let ms = run.stamp_ns().iter().map(|ns| (ns - run.stamp_ns()[0]) / 1_000_000).collect();
        (ms, run.remarks.as_slice().iter().map(|remark| remark.code).collect())
    }

    #[test]
    fn rows_that_were_written_twice_count_once_and_those_of_a_coarse_clock_all() {
        let row = |time: f64, k: u32| format!("{time:.2},{k},{}\n", f64::from(k) - 0.5);
        let (ms, codes) = read(|k| row(0.02 * f64::from(k / 2), k / 2));
        let even: Vec<i64> = (0..20).map(|k| 20 * k).collect();
        assert_eq!((ms, codes), (even, vec![Code::DuplicateStamp]));
        let (ms, codes) = read(|k| row(f64::from(k / 4), k));
        assert_eq!((ms.len(), codes), (40, vec![Code::Guessed]));
        // Nor those of one at which the joint mostly rests.
        let (ms, codes) = read(|k| row(f64::from(k / 4), k.clamp(20, 23)));
        assert_eq!((ms.len(), codes), (40, vec![Code::Guessed]));
        let few = "t_s,J1_target_deg,J1_actual_deg\n0,0,0\n0,0,0\n0.1,1,1\n0.1,1,1\n0.2,2,1\n0.2,2,1\n";
        let run = read_csv_bytes("a.csv", few.as_bytes(), &CsvOptions::default()).unwrap();
        assert_eq!((run.stamp_ns().len(), run.remarks.as_slice().len()), (3, 1));
    }
}
