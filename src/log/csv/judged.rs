//! Rows that the recorder itself calls bad, as historians do beside each value.

use ::csv::ByteRecord;

use super::{
    CsvOptions,
    head::{Head, looked_at},
    rows::{cell_text, rewritten},
};
use crate::remark::{Code, Remarks};

/// Headers of columns that say how good a row is.
const JUDGES: [&str; 8] =
    ["quality", "status", "statuscode", "status_code", "opc_quality", "opcquality", "validity", "qualität"];
/// What they say of a good row, and of a bad one.
const GOOD: [&str; 4] = ["good", "ok", "valid", "gut"];
const BAD: [&str; 7] = ["bad", "invalid", "error", "err", "fault", "schlecht", "badwaitingforinitialdata"];
/// Headers of columns that say of a row whether it is good, and what they say then and else.
const WHETHER: [&str; 3] = ["valid", "is_valid", "isvalid"];
const YES: [&str; 3] = ["true", "1", "1.0"];
const NO: [&str; 3] = ["false", "0", "0.0"];
/// Where more than one row in so many is bad, the column means another thing: that a motion is under way.
const MOST: u64 = 5;

/// In the quality of OPC, 0 to 255, good begins with 192, and below 64 all is bad.
const OPC_GOOD: &str = "192";
const OPC_BELOW_IS_BAD: u8 = 64;

/// What tells a bad row.
#[derive(Debug)]
pub(super) struct Judge {
    column: usize,
    is_opc: bool,
    /// Whether it only says yes or no.
    whether: bool,
    /// What it says of a bad row.
    bad: &'static [&'static str],
    header: String,
}

impl Judge {
    /// By the first rows of a table; `None` of one without such a column.
    pub(super) fn of(head: &Head) -> Option<Self> {
        (0..head.names.len()).find_map(|column| Self::of_column(head, column))
    }

    fn of_column(head: &Head, column: usize) -> Option<Self> {
        let plain = head.names[column].trim_matches(['_', ' ']).to_lowercase();
        let whether = WHETHER.contains(&plain.as_str());
        let [good, bad]: [&[&str]; 2] = if whether { [&YES, &NO] } else { [&GOOD, &BAD] };
        let sample = || head.sample.iter().filter_map(|row| row.get(column));
        let is_opc = plain.contains("quali")
            && sample().any(|cell| says(cell, &[OPC_GOOD]))
            && sample().all(|cell| opc(cell).is_some());
        let tells = is_opc || sample().any(|cell| says(cell, good));
        let answers = !whether || sample().all(|cell| says(cell, good) || says(cell, bad));
        let judges = whether || JUDGES.contains(&plain.as_str());
        let header = head.names[column].clone();
        (judges && tells && answers).then_some(Self { column, is_opc, whether, bad, header })
    }

    pub(super) fn is_bad(&self, row: &ByteRecord) -> bool {
        row.get(self.column).is_some_and(|cell| {
            if self.is_opc { opc(cell).is_some_and(|of| of < OPC_BELOW_IS_BAD) } else { says(cell, self.bad) }
        })
    }

    /// Says how many rows were.
    pub(super) fn remark(&self, bad: u64, remarks: &mut Remarks) {
        remarks.add(Code::NotFinite, bad, format!("rows that column {:?} calls bad; left out", self.header));
    }
}

fn says(cell: &[u8], words: &[&str]) -> bool {
    // `Bad [0]`, as some write with the number behind it.
    let text = cell_text(cell).to_lowercase();
    words.contains(&text.split(['[', '(']).next().unwrap_or_default().trim_end())
}

fn opc(cell: &[u8]) -> Option<u8> {
    cell_text(cell).parse().ok()
}

/// The table without the rows that a column of its own calls bad.
pub(super) fn without_bad(
    file: &str,
    text: &[u8],
    options: &CsvOptions,
    remarks: &mut Remarks,
) -> Option<Vec<u8>> {
    let (dialect, head) = looked_at(file, text, options)?;
    let judge = Judge::of(&head)?;
    let (mut bad, mut rows) = (0, 0);
    let kept = rewritten(text, dialect.separator, |line, record, kept| {
        let is_bad = line >= head.first_line && judge.is_bad(record);
        (bad, rows) = (bad + u64::from(is_bad), rows + 1);
        if is_bad { Ok(()) } else { kept.write_byte_record(record) }
    });
    if judge.whether && MOST * bad > rows {
        return None;
    }
    judge.remark(bad, remarks);
    kept.filter(|_| bad > 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_that_are_called_bad_are_left_out_and_counted() {
        let of = |text: &str| {
            let mut remarks = Remarks::default();
            let kept = without_bad("a.csv", text.as_bytes(), &CsvOptions::default(), &mut remarks);
            let counts = remarks.as_slice().iter().map(|remark| remark.count).sum::<u64>();
            (kept.map_or(text.to_owned(), |kept| String::from_utf8(kept).unwrap()), counts)
        };
        let text = "t,q,Quality\n0,1,Good\n1,0,Bad\n2,1,Good\n3,0,bad\n";
        assert_eq!(of(text), ("t,q,Quality\n0,1,Good\n2,1,Good\n".into(), 2));
        let opc = "t,q,Quality\n0,1,192\n1,0,0\n2,1,216\n3,2,64\n";
        assert_eq!(of(opc), ("t,q,Quality\n0,1,192\n2,1,216\n3,2,64\n".into(), 1));
        for text in ["t,q,status\n0,1,192\n1,0,0\n", "t,q,quality\n0,1,1\n1,0,0\n"] {
            assert_eq!(of(text), (text.to_owned(), 0));
        }
        for text in ["t,q,status\n0,1,run\n1,0,error\n", "t,q,quality\n0,1,good\n", "t,q\n0,1\n"] {
            assert_eq!(of(text), (text.to_owned(), 0));
        }
    }
}
