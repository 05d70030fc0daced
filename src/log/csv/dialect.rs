//! How a file separates its cells and writes its numbers.

use ::csv::ByteRecord;

use super::{
    CsvError, CsvOptions, Separator,
    number::{Looks, looks},
    rows::Rows,
};

/// How a file is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Dialect {
    pub(super) separator: Separator,
    pub(super) decimal_comma: bool,
    /// Cells in most rows.
    pub(super) width: usize,
}

impl Dialect {
    /// How a table of this dialect is read after its rows were written anew with [`writer`](super::rows::writer).
    pub(super) fn rewritten(self, options: &CsvOptions) -> CsvOptions {
        let separator = match self.separator {
            Separator::Space => Separator::Byte(b'\t'),
            byte @ Separator::Byte(_) => byte,
        };
        CsvOptions { separator: Some(separator), decimal_comma: Some(self.decimal_comma), ..options.clone() }
    }
}

/// Bytes and rows that are looked at.
const HEAD_BYTES: usize = 1 << 18;
const HEAD_ROWS: usize = 200;

/// Earlier ones win where several would do.
const CANDIDATES: [Separator; 5] = [
    Separator::Byte(b';'),
    Separator::Byte(b'\t'),
    Separator::Byte(b'|'),
    Separator::Byte(b','),
    Separator::Space,
];

/// The start of a file, whole lines of it where it has some.
pub(super) fn head(text: &[u8]) -> &[u8] {
    let cut = text.get(..HEAD_BYTES).unwrap_or(text);
    let whole = if cut.len() < text.len() {
        memchr::memrchr(b'\n', cut).map_or(cut.len(), |at| at + 1)
    } else {
        cut.len()
    };
    &cut[..whole]
}

pub(super) fn detect(file: &str, text: &[u8], options: &CsvOptions) -> Result<Dialect, CsvError> {
    let candidates = match &options.separator {
        Some(given) => std::slice::from_ref(given),
        None => &CANDIDATES[..],
    };
    let mut best: Option<Trial> = None;
    for &separator in candidates {
        let trial = Trial::new(head(text), separator, options.decimal_comma);
        if trial.width >= 2 && best.as_ref().is_none_or(|best| trial.score() > best.score() + 1e-9) {
            best = Some(trial);
        }
    }
    let none = |found: &str| CsvError::NoTable { file: file.to_owned(), found: found.to_owned() };
    let Some(best) = best else {
        return Err(none(if text.trim_ascii().is_empty() {
            "it is empty"
        } else {
            "no two cells stand beside each other"
        }));
    };
    if best.numbers == 0 {
        return Err(none("no cell is a number"));
    }
    let comma = best.commas > best.points && best.separator != Separator::Byte(b',');
    Ok(Dialect {
        separator: best.separator,
        decimal_comma: options.decimal_comma.unwrap_or(comma),
        width: best.width,
    })
}

/// The head of a file as one separator would cut it.
struct Trial {
    separator: Separator,
    width: usize,
    rows: usize,
    /// Rows of that width.
    fitting: usize,
    cells: usize,
    numbers: usize,
    points: usize,
    commas: usize,
}

impl Trial {
    fn new(head: &[u8], separator: Separator, decimal_comma: Option<bool>) -> Self {
        let mut rows = Rows::new(head, separator);
        let mut record = ByteRecord::new();
        let mut read: Vec<Vec<Looks>> = Vec::new();
        while read.len() < HEAD_ROWS && rows.next(&mut record).is_some() {
            read.push(record.iter().map(looks).collect());
        }
        let mut widths: Vec<usize> = read.iter().map(Vec::len).collect();
        widths.sort_unstable();
        let width =
            widths.chunk_by(|a, b| a == b).max_by_key(|run| (run.len(), run[0])).map_or(0, |run| run[0]);
        let mut trial = Self {
            separator,
            width,
            rows: read.len(),
            fitting: 0,
            cells: 0,
            numbers: 0,
            points: 0,
            commas: 0,
        };
        for row in read.iter().filter(|row| row.len() == width) {
            trial.fitting += 1;
            let count = |wanted: Looks| row.iter().filter(|looks| **looks == wanted).count();
            let (points, commas) = (count(Looks::Point), count(Looks::Comma));
            let fractions = match decimal_comma {
                None => points + commas,
                Some(true) => commas,
                Some(false) => points,
            };
            trial.cells += row.len() - count(Looks::Empty);
            trial.numbers += fractions + count(Looks::Whole) + count(Looks::Date);
            trial.points += points;
            trial.commas += commas;
        }
        // A comma that separates is no decimal comma.
        if trial.points > 0 && trial.commas > 0 {
            trial.numbers -= trial.points.min(trial.commas).min(trial.numbers);
        }
        trial
    }

    /// Part of the rows that have as many cells, and of their cells that are numbers.
    fn score(&self) -> f64 {
        let part = |some: usize, all: usize| if all == 0 { 0.0 } else { some as f64 / all as f64 };
        part(self.fitting, self.rows) * part(self.numbers, self.cells)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(text: &str) -> (String, bool, usize) {
        let dialect = detect("a.csv", text.as_bytes(), &CsvOptions::default()).unwrap();
        (dialect.separator.name(), dialect.decimal_comma, dialect.width)
    }

    #[test]
    fn separators_and_decimal_marks_are_told_apart() {
        assert_eq!(found("t;a;b\n0,0;1,5;2\n0,1;1,6;2\n"), ("semicolon".into(), true, 3));
        assert_eq!(found("t,a,b\n0.0,1.5,2\n0.1,1.6,2\n"), ("comma".into(), false, 3));
        assert_eq!(found("t\ta\tb\n0,0\t1,5\t2\n0,1\t1,6\t2\n"), ("tab".into(), true, 3));
        assert_eq!(found("t a b\n0,0 1,5 2,5\n0,1 1,6 2,5\n"), ("space".into(), true, 3));
        assert_eq!(found("t, a, b\n0.0, 1.5, 2\n0.1, 1.6, 2\n"), ("comma".into(), false, 3));
        assert_eq!(found("t,a,b\n0.000,0.5,0 1\n0.001,1.5,1 2\n"), ("comma".into(), false, 3));
        assert_eq!(
            found("t;a\n15.06.2025 15:06:40,020;1,5\n15.06.2025 15:06:40,040;1,5\n"),
            ("semicolon".into(), true, 2)
        );
    }

    #[test]
    fn what_is_no_table_is_said_to_be_none() {
        for text in ["", "\n\n", "one\ntwo\n", "a;b\nc;d\n"] {
            let error = detect("a.csv", text.as_bytes(), &CsvOptions::default()).unwrap_err();
            assert!(matches!(error, CsvError::NoTable { .. }), "{text:?}");
        }
    }
}
