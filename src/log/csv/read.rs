//! All rows of a file: a stamp each, and the numbers of the columns in use.

use std::collections::BTreeMap;

use ::csv::ByteRecord;

use super::{
    CsvError,
    again::is_another_header,
    column::clip,
    dialect::Dialect,
    head::Head,
    number::{number, says_absent},
    row_order::{self, FEWEST},
    rows::{Rows, cell_text},
    time::{TimeSource, Wraps},
};
use crate::{
    math::median,
    remark::{Code, Remarks},
    units::NS_PER_S,
};

/// Numbers of one column, `[rows]`; NaN where a cell holds none.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Column {
    pub(super) values: Vec<f64>,
    /// Cells that hold a finite number.
    pub(super) numbers: u64,
    /// Cells that hold something that is no finite number.
    bad: u64,
    /// Those of them that say that there was no number.
    absent: u64,
    /// The first of these and its line.
    example: Option<(String, u64)>,
}

/// The content of the rows.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Cells {
    /// ns since 1970, `[rows]`.
    pub(super) stamp_ns: Vec<i64>,
    /// When each row counts as received, ns since 1970, `[rows]`.
    pub(super) received_ns: Vec<i64>,
    pub(super) absolute: bool,
    /// By column of the file.
    pub(super) columns: BTreeMap<usize, Column>,
}

/// Reads the rows of a file; `wanted` are the columns to read besides the time.
pub(super) fn read(
    file: &str,
    text: &[u8],
    head: &Head,
    dialect: Dialect,
    time: &TimeSource,
    wanted: impl Iterator<Item = usize>,
    remarks: &mut Remarks,
) -> Result<Cells, CsvError> {
    let mut rows = Rows::new(text, dialect.separator);
    let mut record = ByteRecord::new();
    let mut columns: BTreeMap<usize, Column> = wanted.map(|column| (column, Column::default())).collect();
    let mut stamp_ns = Vec::new();
    let (mut row, mut ragged, mut unstamped) = (0_u64, 0_u64, 0_u64);
    let mut ragged_line = None;
    let mut unstamped_example = None;
    let mut ends = Ends::default();
    while let Some(line) = rows.next(&mut record) {
        if line < head.first_line {
            continue;
        }
        if is_another_header(head, &record) {
            return Err(CsvError::AnotherHeader { file: file.to_owned(), line, first: head.line });
        }
        row += 1;
        let beyond = record.iter().skip(dialect.width).any(|cell| !cell.trim_ascii().is_empty());
        if record.len() < dialect.width || beyond {
            ragged += 1;
            ragged_line.get_or_insert((line, record.len()));
            continue;
        }
        let cell = |column: usize| record.get(column).unwrap_or_default();
        let Some(ns) = time.ns(row - 1, cell, dialect.decimal_comma) else {
            unstamped += 1;
            let example =
                || (time.columns().first().map_or_else(String::new, |&c| clip(&cell_text(cell(c)))), line);
            unstamped_example.get_or_insert_with(example);
            continue;
        };
        stamp_ns.push(ns);
        ends.note(record.iter().next_back().unwrap_or_default(), dialect.decimal_comma);
        for (&at, column) in &mut columns {
            column.push(cell(at), line, dialect.decimal_comma);
        }
    }
    if let Some((line, cells)) = ragged_line {
        let message = format!(
            "rows that are not {} cells wide, such as line {line} with {cells}; left out",
            dialect.width
        );
        remarks.add(Code::LengthMismatch, ragged, message);
    }
    if !text.ends_with(b"\n") && ends.is_cut() {
        stamp_ns.pop();
        columns.values_mut().for_each(Column::pop);
        let message = "last row, which breaks off in a number: the file was cut there; left out";
        remarks.add(Code::NotClosed, 1, message);
    }
    let mut wraps = Wraps::default();
    for ns in &mut stamp_ns {
        *ns = wraps.undone(time, *ns);
    }
    wraps.remark(remarks);
    if let Some(rows) = row_order::in_order(&stamp_ns, time.is_of_day(), remarks) {
        stamp_ns = rows.iter().map(|row| stamp_ns[*row]).collect();
        for column in columns.values_mut() {
            column.take(&rows);
        }
    }
    let placed = time.placed(&stamp_ns);
    let absolute = time.settle(&mut stamp_ns);
    keep(&placed, &mut stamp_ns, &mut columns);
    let outside = drop_outside(&mut stamp_ns, &mut columns);
    let clock = time.columns().first().map_or("", |&column| head.names[column].as_str());
    judge_stamps(clock, stamp_ns.len() as u64, unstamped, outside, unstamped_example, dialect, remarks)?;
    let received_ns = received(&stamp_ns, remarks);
    for (at, column) in &columns {
        column.judge(&head.names[*at], dialect, remarks)?;
    }
    Ok(Cells { stamp_ns, received_ns, absolute, columns })
}

/// An error if most rows have no time, a remark if some rows have no time.
fn judge_stamps(
    column: &str,
    stamped: u64,
    unstamped: u64,
    outside: u64,
    example: Option<(String, u64)>,
    dialect: Dialect,
    remarks: &mut Remarks,
) -> Result<(), CsvError> {
    let such = such(example.as_ref());
    if stamped <= unstamped + outside {
        let marks = example.is_some_and(|(text, _)| text.contains(['.', ',']));
        let fix = match (marks, dialect.decimal_comma) {
            (true, false) => "say --decimal-comma, --time COLUMN or --rate HZ",
            (true, true) => "say --decimal-point, --time COLUMN or --rate HZ",
            (false, _) => "say --time COLUMN, --time-unit UNIT or --rate HZ",
        };
        let (column, bad) = (column.to_owned(), unstamped + outside);
        let have = if outside > unstamped { "one outside of that, as before a clock is set" } else { "none" };
        return Err(CsvError::NoStamps { column, stamped, bad, have, example: such, fix });
    }
    remarks.add(Code::UnusableStamp, unstamped, format!("rows without a time in {column:?}{such}; left out"));
    let message = format!("rows whose time in {column:?} lies outside 1970 to 2038; left out");
    remarks.add(Code::UnusableStamp, outside, message);
    Ok(())
}

/// The text of an unexpected cell, and its line.
fn such(example: Option<&(String, u64)>) -> String {
    example.map_or_else(String::new, |(text, line)| format!(", such as {text:?} in line {line}"))
}

/// Rows before the last that tell how long a whole number should be.
const NEIGHBOURS: usize = 3;

/// How the last cells of the rows end, to tell a number that was cut from one that is short.
#[derive(Debug, Clone, Default)]
pub(super) struct Ends {
    rows: u64,
    /// Fewest digits behind the decimal mark in all rows but the last.
    fewest: Option<usize>,
    /// The last rows but one, and the last.
    beside: [End; NEIGHBOURS],
    last: End,
}

/// How one row ends.
#[derive(Debug, Clone, Copy, Default)]
struct End {
    /// Digits behind the decimal mark.
    digits: usize,
    /// Digits of a whole number, 0 of others, and the number.
    whole: usize,
    value: f64,
    /// Ends where no number does.
    open: bool,
}

impl Ends {
    pub(super) fn note(&mut self, cell: &[u8], decimal_comma: bool) {
        let cell = cell.trim_ascii();
        let mark = if decimal_comma { b',' } else { b'.' };
        if self.rows > 0 {
            self.fewest = Some(self.fewest.map_or(self.last.digits, |fewest| fewest.min(self.last.digits)));
            self.beside.rotate_left(1);
            self.beside[NEIGHBOURS - 1] = self.last;
        }
        let unsigned = cell.strip_prefix(b"-").unwrap_or(cell);
        let whole = if unsigned.iter().all(u8::is_ascii_digit) { unsigned.len() } else { 0 };
        self.last = End {
            digits: memchr::memchr(mark, cell).map_or(0, |at| cell.len() - at - 1),
            whole,
            value: number(cell, decimal_comma).unwrap_or_default(),
            open: cell.last().is_some_and(|&end| end == mark || b"+-eE".contains(&end)),
        };
        self.rows += 1;
    }

    pub(super) fn is_cut(&self) -> bool {
        let [first, second, before] = self.beside;
        let short = self.fewest.is_some_and(|fewest| self.last.digits < fewest);
        let step = |a: End, b: End| (a.value - b.value).abs();
        // 99 after 100 is shorter, too, but no farther than the rows before it are from each other.
        let far = step(self.last, before) > 3.0 * step(before, second).max(step(second, first));
        let shorter = far && self.last.whole > 0 && self.beside.iter().all(|end| self.last.whole < end.whole);
        self.rows > NEIGHBOURS as u64 && (self.last.open || short || shorter)
    }
}

impl Column {
    /// A column of numbers, NaN where there is none.
    pub(super) fn of(values: Vec<f64>) -> Self {
        let numbers = values.iter().filter(|value| value.is_finite()).count() as u64;
        Self { values, numbers, ..Self::default() }
    }

    /// These rows, in this order.
    fn take(&mut self, rows: &[usize]) {
        self.values = rows.iter().map(|row| self.values[*row]).collect();
        self.numbers = self.values.iter().filter(|value| value.is_finite()).count() as u64;
    }

    /// Without the last row.
    fn pop(&mut self) {
        self.numbers -= u64::from(self.values.pop().is_some_and(f64::is_finite));
    }

    pub(super) fn push(&mut self, cell: &[u8], line: u64, decimal_comma: bool) {
        let value = number(cell, decimal_comma).filter(|value| value.is_finite());
        if value.is_some() {
            self.numbers += 1;
        } else if !cell.trim_ascii().is_empty() {
            self.bad += 1;
            self.absent += u64::from(says_absent(cell));
            self.example.get_or_insert_with(|| (clip(&cell_text(cell)), line));
        }
        self.values.push(value.unwrap_or(f64::NAN));
    }

    /// Cells that hold something that is no number.
    pub(super) fn bad(&self) -> u64 {
        self.bad
    }

    /// The largest finite magnitude.
    pub(super) fn reach(&self) -> f64 {
        self.values.iter().filter(|value| value.is_finite()).fold(0.0, |most, value| value.abs().max(most))
    }

    /// An error if most cells hold something else than numbers, a remark if some do.
    fn judge(&self, name: &str, dialect: Dialect, remarks: &mut Remarks) -> Result<(), CsvError> {
        let such = such(self.example.as_ref());
        let mark = if dialect.decimal_comma { '.' } else { ',' };
        let marks = self.example.as_ref().is_some_and(|(text, _)| text.contains(mark));
        // Whole numbers look the same with either mark: a tenth of others says that it is wrong.
        let most = if marks { self.numbers / 10 } else { self.numbers };
        if self.bad - self.absent > most {
            return Err(CsvError::NoNumbers {
                column: name.to_owned(),
                numbers: self.numbers,
                decimal: if dialect.decimal_comma { "comma" } else { "point" },
                bad: self.bad - self.absent,
                example: such,
                fix: match (marks, dialect.decimal_comma) {
                    (true, false) => "say --decimal-comma",
                    (true, true) => "say --decimal-point",
                    (false, _) => "map another column",
                },
            });
        }
        let message = format!("cells of {name:?} that are no number{such}; left empty");
        remarks.add(Code::NotFinite, self.bad, message);
        let all = if self.numbers == 0 { self.values.len() as u64 } else { 0 };
        remarks.add(Code::NotFinite, all, format!("cells of {name:?}, all of them, are empty"));
        Ok(())
    }
}

/// Drops rows that no message can be stamped with; how many.
fn drop_outside(stamp_ns: &mut Vec<i64>, columns: &mut BTreeMap<usize, Column>) -> u64 {
    const LAST_NS: i64 = i32::MAX as i64 * 1_000_000_000;
    let inside: Vec<bool> = stamp_ns.iter().map(|ns| (1..LAST_NS).contains(ns)).collect();
    keep(&inside, stamp_ns, columns)
}

/// Drops the rows that are not to be kept; how many.
fn keep(kept: &[bool], stamp_ns: &mut Vec<i64>, columns: &mut BTreeMap<usize, Column>) -> u64 {
    let dropped = kept.iter().filter(|kept| !**kept).count() as u64;
    if dropped == 0 {
        return 0;
    }
    let mut place = kept.iter();
    stamp_ns.retain(|_| place.next().copied().unwrap_or(false));
    for column in columns.values_mut() {
        let mut place = kept.iter();
        column.values.retain(|_| place.next().copied().unwrap_or(false));
        column.numbers = column.values.iter().filter(|value| value.is_finite()).count() as u64;
    }
    dropped
}

/// What is said of rows that repeat a stamp, and of rows that came late.
pub(super) const REPEATED: &str =
    "rows with the time of the row before; kept as they are, a report uses the first of each";
pub(super) const LATE: &str = "rows earlier than the row before; a report puts those that came late in their place and leaves out the others";

/// When a recorder beside the controller would have received the rows, ns: never earlier than the row before,
/// and on at the usual step where the clock was set back. By it a report tells rows that came late from a clock
/// that jumped, and splits the run there.
fn received(stamp_ns: &[i64], remarks: &mut Remarks) -> Vec<i64> {
    let steps = || stamp_ns.windows(2).map(|w| w[1].saturating_sub(w[0]));
    let repeated = steps().filter(|step| *step == 0).count() as u64;
    remarks.add(Code::DuplicateStamp, repeated, REPEATED);
    let forward: Vec<f64> = steps().filter(|step| *step > 0).map(|step| step as f64).collect();
    let usual_ns = if forward.is_empty() { 0 } else { whole_ns(median(forward)) };
    let (mut shift_ns, mut latest_ns) = (0_i64, i64::MIN);
    let (mut late, mut jumps, mut longest_ns) = (0_u64, 0_u64, 0_i64);
    let mut received = Vec::with_capacity(stamp_ns.len());
    for (row, &stamp) in stamp_ns.iter().enumerate() {
        let behind_ns = latest_ns.saturating_sub(stamp.saturating_add(shift_ns));
        if row > 0 && behind_ns > 0 {
            if stays(&stamp_ns[row..], stamp.saturating_add(behind_ns), usual_ns) {
                jumps += 1;
                longest_ns = longest_ns.max(behind_ns);
                shift_ns = shift_ns.saturating_add(behind_ns).saturating_add(usual_ns);
            } else {
                late += 1;
            }
        }
        latest_ns = latest_ns.max(stamp.saturating_add(shift_ns));
        received.push(latest_ns);
    }
    remarks.add(Code::Reordered, late, LATE);
    let message = format!(
        "places where the clock goes back, by up to {:.3} s; no row is lost, a report splits the run there and \
         goes on in the order of the rows",
        longest_ns as f64 / NS_PER_S
    );
    remarks.add(Code::ClockJump, jumps, message);
    received
}

/// Whether the clock stays back: the next rows go on at the usual step, or do not catch up with the latest.
fn stays(stamp_ns: &[i64], latest_ns: i64, usual_ns: i64) -> bool {
    let Some(next) = stamp_ns.get(..FEWEST) else { return false };
    let steady =
        next.windows(2).all(|w| w[1] >= w[0] && w[1] - w[0] <= usual_ns.saturating_add(usual_ns / 2));
    steady || next.iter().all(|stamp| *stamp < latest_ns)
}

#[expect(clippy::cast_possible_truncation, reason = "a step of a clock of i64 ns")]
fn whole_ns(ns: f64) -> i64 {
    ns as i64
}
