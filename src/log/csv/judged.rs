//! Rows and values that the recorder itself calls bad, as historians and servers of OPC do beside each value.

use ::csv::ByteRecord;

use super::{
    CsvOptions,
    head::{Head, looked_at},
    label::Label,
    rows::{cell_text, rewritten},
};
use crate::remark::{Code, Remarks};

/// How a column says whether what it judges is good.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// A word.
    Word,
    /// A quality of OPC, 0 to 255.
    Opc,
    /// A status code of OPC UA.
    Code,
    /// Yes for good.
    Whether,
    /// Yes for bad.
    Doubt,
}

/// Headers of columns that say how good a row is; behind the name of a signal, how good its value is.
const JUDGES: [(&str, Kind); 3] = [
    (
        "quality qual qualität status statuscode status_code opc_quality opcquality quality_code qualitycode validity \
         dataintegrity data_integrity",
        Kind::Word,
    ),
    ("valid is_valid isvalid good ok", Kind::Whether),
    ("questionable", Kind::Doubt),
];
/// What they say of what is good, and of what is bad.
const GOOD: [&str; 4] = ["good", "ok", "valid", "gut"];
const BAD: [&str; 7] = ["bad", "invalid", "error", "err", "fault", "schlecht", "badwaitingforinitialdata"];
const YES: [&str; 3] = ["true", "1", "1.0"];
const NO: [&str; 3] = ["false", "0", "0.0"];
/// Where more than one row in so many is bad by a yes or no, the column means another thing: that a motion is under way.
const MOST: u64 = 5;

/// In the quality of OPC, 0 to 255, good begins with 192, and below 64 all is bad.
const OPC_GOOD: &str = "192";
const OPC_BELOW_IS_BAD: u64 = 64;
/// In the status codes of OPC UA 0 is good, what is uncertain begins here, and from there on all is bad.
const UNCERTAIN: u64 = 0x4000_0000;
const FROM_IS_BAD: u64 = 0x8000_0000;

/// What tells that a row is bad, or the value of a signal in it.
#[derive(Debug)]
struct Judge {
    column: usize,
    /// The column of the signal; the whole row without.
    of: Option<usize>,
    kind: Kind,
}

/// What they say of a row.
#[derive(Debug, PartialEq)]
pub(super) enum Verdict {
    /// It is good.
    Good,
    /// It is bad.
    Bad,
    /// These of its values are.
    BadCells(Vec<usize>),
}

/// All of a table.
#[derive(Debug, Default)]
pub(super) struct Judges {
    list: Vec<Judge>,
    /// The headers of the one of rows, and of the first of values.
    headers: [String; 2],
}

impl Judges {
    /// By the first rows of a table; of those that judge all of a row the first counts.
    pub(super) fn of(head: &Head) -> Self {
        let labels = head.labels();
        let found = |column| Judge::of_column(head, &labels, column);
        let (of_rows, mut list): (Vec<Judge>, Vec<Judge>) =
            (0..head.names.len()).filter_map(found).partition(|judge| judge.of.is_none());
        list.extend(of_rows.into_iter().next());
        let headers = [true, false].map(|of_row| {
            let first = list.iter().find(|judge| judge.of.is_none() == of_row);
            first.map_or_else(String::new, |judge| head.names[judge.column].clone())
        });
        Self { list, headers }
    }

    pub(super) fn says(&self, row: &ByteRecord) -> Verdict {
        let bad = || self.list.iter().filter(|judge| judge.is_bad(row)).map(|judge| judge.of);
        if bad().any(|of| of.is_none()) {
            return Verdict::Bad;
        }
        let cells: Vec<usize> = bad().flatten().collect();
        if cells.is_empty() { Verdict::Good } else { Verdict::BadCells(cells) }
    }

    /// Says how many rows or values were bad.
    pub(super) fn remark(&self, [rows, values]: [u64; 2], remarks: &mut Remarks) {
        let [of_rows, of_values] = &self.headers;
        remarks.add(Code::NotFinite, rows, format!("rows that column {of_rows:?} calls bad; left out"));
        let message =
            format!("values that a column of their own, such as {of_values:?}, calls bad; left out");
        remarks.add(Code::NotFinite, values, message);
    }
}

/// A row without those of its values.
pub(super) fn emptied(row: &ByteRecord, cells: &[usize]) -> ByteRecord {
    let kept = |(column, cell)| if cells.contains(&column) { &[][..] } else { cell };
    row.iter().enumerate().map(kept).collect()
}

impl Judge {
    fn of_column(head: &Head, labels: &[Label], column: usize) -> Option<Self> {
        let name = head.names[column].trim_matches(['_', ' ']).to_lowercase();
        let of_kind = |(words, kind): &(&'static str, Kind)| {
            let ends = |word: &&str| {
                name.strip_suffix(word).is_some_and(|before| !before.ends_with(char::is_alphanumeric))
            };
            words
                .split_ascii_whitespace()
                .filter(ends)
                .max_by_key(|word| word.len())
                .map(|word| (word, *kind))
        };
        let (word, kind) = JUDGES.iter().filter_map(of_kind).max_by_key(|(word, _)| word.len())?;
        let of = match name[..name.len() - word.len()].trim_end_matches(|c: char| !c.is_alphanumeric()) {
            "" => None,
            signal => Some(judged(head, labels, signal)?),
        };
        let sample = || head.sample.iter().filter_map(|row| row.get(column));
        let numbers = |most: u64| sample().all(|cell| number(cell).is_some_and(|of| of <= most));
        let is_opc = word.contains("qual") || word.contains("integrity");
        let is_code = |cell: &Vec<u8>| number(cell).is_some_and(|of| of == 0 || of >= UNCERTAIN);
        let kind = match kind {
            Kind::Word if is_opc && numbers(255) && sample().any(|cell| says(cell, &[OPC_GOOD])) => Kind::Opc,
            Kind::Word if word.contains("code") && sample().all(is_code) => Kind::Code,
            other => other,
        };
        let [usual, unusual]: [&[&str]; 2] = match kind {
            Kind::Opc | Kind::Code => return Some(Self { column, of, kind }),
            Kind::Word => [&GOOD, &[]],
            Kind::Whether => [&YES, &NO],
            Kind::Doubt => [&NO, &YES],
        };
        let answers = |cell: &Vec<u8>| kind == Kind::Word || says(cell, usual) || says(cell, unusual);
        let tells = sample().any(|cell| says(cell, usual)) && sample().all(answers);
        tells.then_some(Self { column, of, kind })
    }

    fn is_bad(&self, row: &ByteRecord) -> bool {
        let cell = row.get(self.column).unwrap_or_default();
        match self.kind {
            Kind::Word => says(cell, &BAD),
            Kind::Opc => number(cell).is_some_and(|of| of < OPC_BELOW_IS_BAD),
            Kind::Code => number(cell).is_some_and(|of| of >= FROM_IS_BAD),
            Kind::Whether => says(cell, &NO),
            Kind::Doubt => says(cell, &YES),
        }
    }

    /// Whether it only says yes or no.
    fn answers(&self) -> bool {
        matches!(self.kind, Kind::Whether | Kind::Doubt)
    }
}

/// The one signal whose header begins so, in small letters.
fn judged(head: &Head, labels: &[Label], begins: &str) -> Option<usize> {
    let is = |column: &usize| {
        let rest = head.names[*column].to_lowercase();
        let rest = rest.trim_start_matches('_').strip_prefix(begins).map(str::to_owned);
        labels[*column].is_joint && rest.is_some_and(|rest| !rest.starts_with(char::is_alphanumeric))
    };
    let mut found = (0..labels.len()).filter(is);
    found.next().filter(|_| found.next().is_none())
}

fn says(cell: &[u8], words: &[&str]) -> bool {
    // `Bad [0]`, as some write with the number behind it.
    let text = cell_text(cell).to_lowercase();
    words.contains(&text.split(['[', '(']).next().unwrap_or_default().trim_end())
}

fn number(cell: &[u8]) -> Option<u64> {
    let text = cell_text(cell);
    text.strip_prefix("0x").map_or_else(|| text.parse().ok(), |digits| u64::from_str_radix(digits, 16).ok())
}

/// The table without the rows and values that columns of its own call bad.
pub(super) fn without_bad(
    file: &str,
    text: &[u8],
    options: &CsvOptions,
    remarks: &mut Remarks,
) -> Option<Vec<u8>> {
    let (dialect, head) = looked_at(file, text, options)?;
    let mut judges = Judges::of(&head);
    loop {
        let mut rows = 0;
        let mut by_judge = vec![0; judges.list.len()];
        let mut bad = [0; 2];
        let kept = rewritten(text, dialect.separator, |line, record, kept| {
            let verdict = if line < head.first_line { Verdict::Good } else { judges.says(record) };
            rows += 1;
            for (judge, bad) in judges.list.iter().zip(&mut by_judge).filter(|_| verdict != Verdict::Good) {
                *bad += u64::from(judge.is_bad(record));
            }
            match verdict {
                Verdict::Good => kept.write_byte_record(record),
                Verdict::Bad => {
                    bad[0] += 1;
                    Ok(())
                }
                Verdict::BadCells(cells) => {
                    bad[1] += cells.len() as u64;
                    kept.write_byte_record(&emptied(record, &cells))
                }
            }
        });
        let mut counts = by_judge.into_iter();
        let before = judges.list.len();
        judges.list.retain(|judge| {
            let bad = counts.next().unwrap_or(0);
            !judge.answers() || MOST * bad <= rows
        });
        if judges.list.len() == before {
            judges.remark(bad, remarks);
            return kept.filter(|_| bad != [0; 2]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_that_its_own_column_calls_bad_is_left_out_alone() {
        let mut remarks = Remarks::default();
        let text = "t,boom_set_deg,boom_set_Quality,boom_act_deg,boom_act_Quality\n0,1,192,2,192\n1,3,192,0,0\n2,0,24,0,0\n3,4,192,4,192\n";
        let kept = without_bad("a.csv", text.as_bytes(), &CsvOptions::default(), &mut remarks).unwrap();
        let rows = ["0,1,192,2,192", "1,3,192,,0", "2,,24,,0", "3,4,192,4,192"];
        assert_eq!(String::from_utf8(kept).unwrap().lines().skip(1).collect::<Vec<_>>(), rows);
        assert_eq!(remarks.as_slice()[0].count, 3);
    }

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
        let code = "t,q,StatusCode\n0,1,0\n1,0,2150891520\n2,1,0\n";
        assert_eq!(of(code), ("t,q,StatusCode\n0,1,0\n2,1,0\n".into(), 1));
        let doubt = "t,q,questionable\n0,1,False\n1,1,False\n2,1,False\n3,1,False\n4,1,False\n5,0,True\n";
        assert_eq!(of(doubt).1, 1);
        for text in ["t,q,status\n0,1,run\n1,0,error\n", "t,q,quality\n0,1,good\n", "t,q\n0,1\n"] {
            assert_eq!(of(text), (text.to_owned(), 0));
        }
    }
}
