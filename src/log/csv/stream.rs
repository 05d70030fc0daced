//! Rows that come one by one, as from a controller that runs.

use std::{borrow::Cow, io::Write};

use ::csv::ByteRecord;

use super::{
    CsvError, CsvOptions, CsvRun, Form, Quantity, Understood,
    again::is_another_header,
    by_rows,
    decimal_mark::DecimalMark,
    expression,
    judged::{self, Judges, Verdict},
    live_clock::LiveClock,
    number::number,
    only::{self, Only},
    read::{Cells, Column, Ends},
    rows::Rows,
    si::{self, Settled},
    text,
    time::FIRST_ABSOLUTE_NS,
};
use crate::{
    log::{LogWriter, WriteError, WriteOptions},
    remark::{Code, Remarks},
};

/// Stamps of messages end with 31 bits of seconds.
const LAST_NS: i64 = i32::MAX as i64 * 1_000_000_000;

/// A table whose rows are yet to come. What its columns are is settled by the first rows, as [`read_csv_bytes`] does;
/// a unit is not guessed.
///
/// [`read_csv_bytes`]: super::read_csv_bytes
#[derive(Debug)]
pub struct TableStream {
    form: Form,
    units: Vec<Settled>,
    run: CsvRun,
    rows: u64,
    /// Instants of the first and the last of them.
    span_ns: Option<[i64; 2]>,
    /// Rows that are written; all, if `None`.
    only: Option<Only>,
    /// Line of the first row in what is written first; 0 afterwards.
    first_line: u64,
    clock: LiveClock,
    counts: Counts,
    ends: Ends,
    /// A header with other columns came: what is below it is not read.
    over: bool,
    judges: Judges,
    mark: DecimalMark,
}

/// Rows that are not as they should be.
#[derive(Debug, Clone, Copy, Default)]
struct Counts {
    above: u64,
    cut: u64,
    ragged: u64,
    unstamped: u64,
    bad_cells: u64,
    others: u64,
    called_bad: [u64; 2],
}

impl TableStream {
    /// Settles how rows are read by the first ones, header included.
    ///
    /// # Errors
    ///
    /// [`CsvError`] if that cannot be told, or a unit is neither in the header nor among the options.
    pub fn begin(name: &str, first: &[u8], options: &CsvOptions) -> Result<Self, CsvError> {
        let text = text::of_bytes(name, first)?;
        let mut remarks = Remarks::default();
        let only = Only::of(name, &text, options)?;
        // Rows of the one that is meant may be yet to come.
        let text = match only::of_one(name, Cow::Borrowed(&text), options) {
            Err(CsvError::NoMachine { .. }) => text.clone(),
            one => one?,
        };
        by_rows(name, &text, options)?;
        let form = Form::of(name, &text, options, &mut remarks)?;
        let judges = Judges::of(&form.head);
        let (run, units) = form.read(name, &text, remarks)?;
        let mut run = run.given(options.given());
        // The first rows are counted with all others.
        run.remarks.retain(|remark| !LiveClock::SAYS.contains(&remark.code));
        let guessed =
            |column: &usize| units.iter().any(|unit| unit.column == *column && unit.from == "guess");
        let positions = form.layout.uses.iter().filter(|one| one.quantity == Quantity::Position);
        if let Some(column) = positions.map(|one| one.column).find(guessed) {
            return Err(CsvError::NoUnit { column: form.head.names[column].clone() });
        }
        let mark = DecimalMark::of(&text, &form, options);
        Ok(Self {
            first_line: form.head.first_line,
            only,
            form,
            units,
            run,
            rows: 0,
            span_ns: None,
            clock: LiveClock::default(),
            counts: Counts::default(),
            ends: Ends::default(),
            over: false,
            judges,
            mark,
        })
    }

    /// The same, said to come from a file of this name.
    pub fn named(mut self, file: String) -> Self {
        self.run.understood.file = file;
        self
    }

    /// The same, of rows that follow those of another header: times of a day are of the day that was reached.
    pub fn after(mut self, before: Option<&Self>) -> Self {
        if let Some(before) = before {
            self.clock = before.clock.going_on();
        }
        self
    }

    /// How rows are read; its counts are those of the first rows.
    pub fn understood(&self) -> &Understood {
        &self.run.understood
    }

    /// Rows so far that became samples.
    pub fn rows(&self) -> u64 {
        self.rows
    }

    /// Instants of the first row and of the last one so far.
    pub fn span_ns(&self) -> Option<[i64; 2]> {
        self.span_ns
    }

    /// Whether a header with other columns came: no later row is written.
    pub fn is_over(&self) -> bool {
        self.over
    }

    /// Starts a log of the rows that come.
    ///
    /// # Errors
    ///
    /// [`WriteError`] if `output` takes nothing, or for a name that no log can hold.
    pub fn log<W: Write>(&self, output: W) -> Result<LogWriter<W>, WriteError> {
        self.run.begin(output, WriteOptions::live())
    }

    /// Writes whole lines, at first those that it began with: rows become samples, what is no row is counted.
    ///
    /// # Errors
    ///
    /// [`WriteError`] if the log takes no more.
    pub fn write<W: Write>(&mut self, lines: &[u8], log: &mut LogWriter<W>) -> Result<(), WriteError> {
        let cells = self.cells(lines);
        self.rows += cells.stamp_ns.len() as u64;
        self.run.set_cells(cells);
        self.run.write_rows(log)
    }

    /// As [`TableStream::write`] of a last line without its end: one that breaks off in a number is left out.
    ///
    /// # Errors
    ///
    /// [`WriteError`] if the log takes no more.
    pub fn write_rest<W: Write>(&mut self, line: &[u8], log: &mut LogWriter<W>) -> Result<(), WriteError> {
        let mut record = ByteRecord::new();
        let mut ends = self.ends.clone();
        if Rows::new(line, self.form.dialect.separator).next(&mut record).is_some() {
            ends.note(record.iter().next_back().unwrap_or_default(), self.form.dialect.decimal_comma);
        }
        if record.len() >= self.form.dialect.width && may_be_cut(&record) && ends.is_cut() {
            self.counts.cut += 1;
            return Ok(());
        }
        self.write(line, log)
    }

    fn cells(&mut self, lines: &[u8]) -> Cells {
        let mut rows = Rows::new(lines, self.form.dialect.separator);
        let mut record = ByteRecord::new();
        let mut cells = Cells::default();
        cells.columns.extend(self.form.wanted().map(|column| (column, Column::default())));
        let first_line = std::mem::take(&mut self.first_line);
        while let Some(line) = rows.next(&mut record) {
            if line >= first_line {
                self.row(&record, line, &mut cells);
            } else {
                self.counts.above += u64::from(is_numbers(&record));
            }
        }
        self.counts.bad_cells += cells.columns.values().map(Column::bad).sum::<u64>();
        expression::compute(&self.form.derived, &mut cells);
        for Settled { column, unit, .. } in &self.units {
            si::scale(&mut cells, *column, unit.map_or(1.0, |unit| unit.factor));
        }
        cells
    }

    fn row(&mut self, record: &ByteRecord, line: u64, cells: &mut Cells) {
        let dialect = self.form.dialect;
        self.over |= is_another_header(&self.form.head, record);
        if self.over {
            return;
        }
        let beyond = record.iter().skip(dialect.width).any(|cell| !cell.trim_ascii().is_empty());
        if record.len() < dialect.width || beyond {
            self.counts.ragged += 1;
            return;
        }
        if self.only.as_ref().is_some_and(|only| !only.holds(record)) {
            self.counts.others += 1;
            return;
        }
        let emptied;
        let record = match self.judges.says(record) {
            Verdict::Good => record,
            Verdict::Bad => {
                self.counts.called_bad[0] += 1;
                return;
            }
            Verdict::BadCells(cells) => {
                self.counts.called_bad[1] += cells.len() as u64;
                emptied = judged::emptied(record, &cells);
                &emptied
            }
        };
        let cell = |column: usize| record.get(column).unwrap_or_default();
        self.mark.settle(&mut self.form, record);
        self.mark.note(&self.form, record);
        let dialect = self.form.dialect;
        let Some(ns) =
            self.form.time.ns(self.rows + cells.stamp_ns.len() as u64, cell, dialect.decimal_comma)
        else {
            self.counts.unstamped += 1;
            return;
        };
        // A clock that counted from its start may be set on the way.
        let absolute = self.run.understood.time.absolute || ns >= FIRST_ABSOLUTE_NS;
        let ns = self.clock.settled(&self.form.time, ns, absolute);
        if !(0..=LAST_NS).contains(&ns) {
            self.counts.unstamped += 1;
            return;
        }
        self.ends.note(record.iter().next_back().unwrap_or_default(), dialect.decimal_comma);
        cells.stamp_ns.push(ns);
        let received_ns = self.clock.received(ns);
        self.span_ns = Some([self.span_ns.map_or(received_ns, |[first_ns, _]| first_ns), received_ns]);
        cells.received_ns.push(received_ns);
        for (&at, column) in &mut cells.columns {
            column.push(cell(at), line, dialect.decimal_comma);
        }
    }

    /// Doubts so far.
    pub fn remarks(&self) -> Remarks {
        let mut remarks = self.run.remarks.clone();
        let Counts { above, cut, ragged, unstamped, bad_cells, others, called_bad } = self.counts;
        let width = self.form.dialect.width;
        if let Some(only) = self.only.as_ref().filter(|_| self.form.options.only.is_none()) {
            remarks.add(
                Code::Ambiguous,
                others,
                format!("rows of another machine than {only}, left out; --only COLUMN=VALUE names one"),
            );
        }
        remarks.add(
            Code::NotSupported,
            u64::from(self.over),
            format!(
                "header with other columns, after {} rows: what follows is in a part of its own",
                self.rows
            ),
        );
        let message = "rows above the header, whose columns cannot be told; left out";
        remarks.add(Code::UndecodableMessage, above, message);
        self.judges.remark(called_bad, &mut remarks);
        self.mark.remark(&mut remarks);
        let message = "last row, which breaks off in a number: its sender was stopped there; left out";
        remarks.add(Code::NotClosed, cut, message);
        remarks.add(Code::LengthMismatch, ragged, format!("lines that have not {width} cells; left out"));
        remarks.add(
            Code::NotFinite,
            unstamped,
            "lines without a time, such as a header again, or with one that no log holds; left out",
        );
        remarks.add(Code::NotFinite, bad_cells, "cells that are no number; left empty");
        self.clock.remark(&mut remarks);
        remarks
    }
}

/// Whether a row ends with a number, or a part of one.
fn may_be_cut(record: &ByteRecord) -> bool {
    let last = record.iter().next_back().unwrap_or_default().trim_ascii();
    last.iter().all(|byte| byte.is_ascii_digit() || b"+-.,eE".contains(byte))
}

/// Whether a row begins with numbers.
fn is_numbers(record: &ByteRecord) -> bool {
    record.iter().take(2).all(|cell| number(cell, false).is_some())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::csv::read_csv_bytes;

    fn table(rows: std::ops::Range<i32>) -> String {
        let row = |k: i32| format!("{:.3},{},{}\n", 0.01 * f64::from(k), k, k - 1);
        rows.map(row).collect()
    }

    #[test]
    fn rows_that_come_one_by_one_give_the_log_of_the_whole_table() {
        const HEAD: &str = "t_s,boom_set_mm,boom_act_mm\n";
        let whole = format!("{HEAD}{}", table(0..300));
        let imported = read_csv_bytes("a.csv", whole.as_bytes(), &CsvOptions::default()).unwrap();
        let first = format!("{HEAD}{}", table(0..9));
        let mut stream = TableStream::begin("a.csv", first.as_bytes(), &CsvOptions::default()).unwrap();
        let mut log = imported.begin(Vec::new(), WriteOptions::default()).unwrap();
        stream.write(first.as_bytes(), &mut log).unwrap();
        for k in 9..300 {
            stream.write(table(k..k + 1).as_bytes(), &mut log).unwrap();
        }
        assert_eq!(stream.rows(), 300);
        assert!(log.finish().unwrap() == imported.write(Vec::new()).unwrap());
        assert!(stream.remarks().is_empty(), "{:?}", stream.remarks());
    }

    #[test]
    fn rows_of_another_machine_are_left_out() {
        let row = |k: u32| format!("{k},EX{},{k},{k}\n", 1 + k / 2 % 2);
        let first = format!("t_s,machine,boom_set_mm,boom_act_mm\n{}{}", row(0), row(1));
        let later: String = (2..8).map(row).collect();
        for (only, rows, said) in [(None, 4, 1), (Some("EX1"), 4, 0), (Some("EX2"), 4, 0), (Some("*"), 8, 0)]
        {
            let only = only.map(|value| ("machine".to_owned(), value.to_owned()));
            let options = CsvOptions { only, ..CsvOptions::default() };
            let mut stream = TableStream::begin("a.csv", first.as_bytes(), &options).unwrap();
            let mut log = stream.log(Vec::new()).unwrap();
            stream.write(format!("{first}{later}").as_bytes(), &mut log).unwrap();
            assert_eq!((stream.rows(), stream.remarks().as_slice().len()), (rows, said), "{options:?}");
        }
        let both = format!("{first}{later}");
        let begun = TableStream::begin("a.csv", both.as_bytes(), &CsvOptions::default());
        assert!(matches!(begun, Err(CsvError::Machines { .. })));
    }

    #[test]
    fn a_unit_is_not_guessed_and_broken_lines_are_counted() {
        let first = "t_s,J1_set,J1_act\n0,0,0\n0.1,0,0\n0.2,0,0\n0.3,0,0\n";
        let begun = TableStream::begin("a.csv", first.as_bytes(), &CsvOptions::default());
        assert!(matches!(begun, Err(CsvError::NoUnit { .. })));
        let first = first.replace("set", "set_deg").replace("act", "act_deg");
        let mut stream = TableStream::begin("a.csv", first.as_bytes(), &CsvOptions::default()).unwrap();
        let mut log = stream.log(Vec::new()).unwrap();
        let row = |k: u32| format!("0.{k:03},0,0\n");
        let after: String = (0..20).map(row).collect();
        stream.write(format!("{first}0.4,0\nx,0,0\n0.5,a,0\n{after}").as_bytes(), &mut log).unwrap();
        let said: Vec<(Code, u64)> =
            stream.remarks().as_slice().iter().map(|remark| (remark.code, remark.count)).collect();
        let expected =
            [(Code::LengthMismatch, 1), (Code::NotFinite, 1), (Code::NotFinite, 1), (Code::ClockJump, 1)];
        assert_eq!(said, expected);
    }
}
