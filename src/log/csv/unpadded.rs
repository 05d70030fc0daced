//! Times whose fraction was written without the zeros before it, as `printf("%ld.%ld", s, us)` does: `7.90000` comes before `7.100000`.

use ::csv::ByteRecord;

use super::{
    CsvOptions, Separator,
    head::looked_at,
    label::label,
    rows::{Rows, rewritten},
};
use crate::remark::{Code, Remarks};

/// Digits of ms, us and ns.
const DIGITS: [usize; 3] = [3, 6, 9];

/// The table with the zeros, where only with them a time rises from row to row.
pub(super) fn padded(
    file: &str,
    text: &[u8],
    options: &CsvOptions,
    remarks: &mut Remarks,
) -> Option<Vec<u8>> {
    let (dialect, head) = looked_at(file, text, options)?;
    let is_time = |at: &usize| {
        let given = options.time.as_deref().is_some_and(|time| time == head.names[*at]);
        given || label(&head.names[*at], None).is_time
    };
    let column = (0..head.names.len()).filter(is_time).find(|at| {
        let cells = head.sample.iter().filter_map(|row| row.get(*at));
        cells.clone().count() > 2 && cells.into_iter().all(|cell| parts(cell).is_some())
    })?;
    let digits = digits(text, dialect.separator, head.first_line, column)?;
    let mut changed = 0;
    let padded = rewritten(text, dialect.separator, |line, record, out| {
        for (at, cell) in record.iter().enumerate() {
            match parts(cell).filter(|_| at == column && line >= head.first_line) {
                Some((whole, fraction)) => {
                    changed += 1;
                    out.write_field(format!("{whole}.{fraction:0>digits$}"))?;
                }
                None => out.write_field(cell)?,
            }
        }
        out.write_record(None::<&[u8]>)
    });
    let unit = ["ms", "us", "ns"][digits / 3 - 1];
    let message = format!(
        "times in {:?} with whole {unit} behind the point, without zeros before: only so do they rise",
        head.names[column]
    );
    remarks.add(Code::Guessed, changed, message);
    padded
}

/// The digits that the fractions have with their zeros; `None` where the times rise as they stand, or do not either way.
fn digits(text: &[u8], separator: Separator, first_line: u64, column: usize) -> Option<usize> {
    let (mut rows, mut record) = (Rows::new(text, separator), ByteRecord::new());
    let mut falls = false;
    let (mut most, mut before) = (0, None::<(u64, u64, f64)>);
    while let Some(line) = rows.next(&mut record) {
        let Some(cell) = record.get(column).filter(|_| line >= first_line) else { continue };
        let (whole, fraction) = parts(cell)?;
        most = most.max(fraction.len());
        let counted = (whole.parse().ok()?, fraction.parse().ok()?);
        let plain: f64 = format!("{whole}.{fraction}").parse().ok()?;
        if let Some((whole, fraction, last)) = before {
            if counted < (whole, fraction) {
                return None;
            }
            falls |= plain < last;
        }
        before = Some((counted.0, counted.1, plain));
    }
    DIGITS.into_iter().find(|digits| falls && *digits >= most)
}

/// What stands before the point and behind it, all of digits.
fn parts(cell: &[u8]) -> Option<(&str, &str)> {
    let (whole, fraction) = std::str::from_utf8(cell).ok()?.trim().split_once('.')?;
    let digits =
        |text: &str| !text.is_empty() && text.len() < 16 && text.bytes().all(|byte| byte.is_ascii_digit());
    (digits(whole) && digits(fraction)).then_some((whole, fraction))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(times: &[&str]) -> (Vec<String>, usize) {
        let text = times.iter().fold("time,q\n".to_owned(), |text, time| format!("{text}{time},1\n"));
        let mut remarks = Remarks::default();
        let table = padded("a.csv", text.as_bytes(), &CsvOptions::default(), &mut remarks);
        let table = table.map_or(text, |table| String::from_utf8(table).unwrap());
        let cells = table.lines().skip(1).map(|line| line.split(',').next().unwrap().to_owned());
        (cells.collect(), remarks.as_slice().len())
    }

    #[test]
    fn us_without_zeros_are_told_by_that_only_with_them_times_rise() {
        let times = ["7.0", "7.90000", "7.100000", "8.5"];
        let expected = ["7.000000", "7.090000", "7.100000", "8.000005"].map(str::to_owned);
        assert_eq!(of(&times), (expected.to_vec(), 1));
        assert_eq!(of(&["0.98", "0.100", "1.0"]).0, ["0.098", "0.100", "1.000"]);
    }

    #[test]
    fn times_that_rise_as_they_stand_and_such_that_do_not_either_way_are_left() {
        for times in
            [["0.1", "0.15", "0.2", "1.0"], ["0.9", "0.10", "0.05", "0.2"], ["0.5", "0.25", "1.0", "0.5"]]
        {
            assert_eq!(of(&times), (times.map(str::to_owned).to_vec(), 0));
        }
    }
}
