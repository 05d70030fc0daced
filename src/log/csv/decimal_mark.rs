//! The decimal mark of rows that come one by one: joints that stand in whole numbers show none, and one that always has three digits
//! behind it may set thousands apart.

use ::csv::ByteRecord;

use super::{
    CsvOptions, Form, Separator,
    number::number,
    rows::{Rows, cell_text},
};
use crate::remark::{Code, Remarks};

/// Whether a decimal mark is still to come.
#[derive(Debug)]
pub(super) struct DecimalMark {
    is_open: bool,
    /// Cells with a mark and three digits behind it, with another number of them, and without a mark of three digits.
    three: u64,
    others: u64,
    whole: u64,
    first: String,
}

impl DecimalMark {
    /// By the first rows.
    pub(super) fn of(text: &[u8], form: &Form, options: &CsvOptions) -> Self {
        let mut rows = Rows::new(text, form.dialect.separator);
        let mut record = ByteRecord::new();
        let mut is_open = options.decimal_comma.is_none() && form.dialect.separator != Separator::Byte(b',');
        while let Some(line) = rows.next(&mut record) {
            is_open &= line < form.head.first_line || marked(form, &record).is_none();
        }
        Self { is_open, three: 0, others: 0, whole: 0, first: String::new() }
    }

    /// The first cell of a joint that has one settles it for all rows.
    pub(super) fn settle(&mut self, form: &mut Form, record: &ByteRecord) {
        if let Some(cell) = marked(form, record).filter(|_| self.is_open) {
            let decimal_comma = number(cell, false).is_none() && number(cell, true).is_some();
            form.dialect.decimal_comma = decimal_comma;
            self.is_open = false;
        }
    }

    /// Counts how the cells of joints in a row look.
    pub(super) fn note(&mut self, form: &Form, record: &ByteRecord) {
        for cell in form.layout.uses.iter().filter_map(|one| record.get(one.column)) {
            let cell = cell.trim_ascii();
            match cell.iter().position(|byte| b",.".contains(byte)) {
                Some(at) if cell.len() == at + 4 => {
                    if self.three == 0 {
                        self.first = cell_text(cell);
                    }
                    self.three += 1;
                }
                Some(_) => self.others += 1,
                None => {
                    let digits = cell.iter().filter(|byte| byte.is_ascii_digit()).count();
                    self.whole += u64::from(digits >= 3);
                }
            }
        }
    }

    /// Marks that always have three digits behind them, beside whole numbers, may set thousands apart.
    pub(super) fn remark(&self, remarks: &mut Remarks) {
        if self.others == 0 && self.whole >= DOUBTED && self.three >= DOUBTED {
            let message = format!(
                "numbers such as {:?} beside whole ones: if the mark sets thousands apart, what was recorded is a thousand times too \
                 small; then import a file of the lines with --decimal-comma or --decimal-point",
                self.first
            );
            remarks.add(Code::Guessed, self.three, message);
        }
    }
}

/// Rows by which a mark is doubted.
const DOUBTED: u64 = 20;

/// The first cell of a joint in a row that has a decimal mark.
fn marked<'a>(form: &Form, record: &'a ByteRecord) -> Option<&'a [u8]> {
    let mut cells = form.wanted().filter_map(|column| record.get(column));
    cells.find(|cell| cell.iter().any(|byte| b",.".contains(byte)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{log::TableStream, remark::Code};

    #[test]
    fn joints_that_stand_in_whole_numbers_leave_the_decimal_mark_open() {
        let row = |k: i32, mark: &str| {
            let value = if k < 40 { "10".to_owned() } else { format!("10{mark}{k:03}") };
            format!("{};{value};{value}\n", 10 * k)
        };
        for mark in [",", "."] {
            let rows = |range: std::ops::Range<i32>| range.map(|k| row(k, mark)).collect::<String>();
            let first = format!("t_ms;boom_set_mm;boom_act_mm\n{}", rows(0..9));
            let mut stream = TableStream::begin("a.csv", first.as_bytes(), &CsvOptions::default()).unwrap();
            let mut log = stream.log(Vec::new()).unwrap();
            stream.write(first.as_bytes(), &mut log).unwrap();
            stream.write(rows(9..100).as_bytes(), &mut log).unwrap();
            let remarks = stream.remarks();
            assert_eq!(stream.rows(), 100);
            assert!(
                remarks.as_slice().iter().all(|remark| remark.code != Code::NotFinite),
                "{mark}: {remarks:?}"
            );
        }
    }
}
