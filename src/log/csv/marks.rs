//! Tables whose columns write numbers in different ways, or set thousands apart only far below the first rows: each column
//! is read by all of its own cells.

use std::borrow::Cow;

use ::csv::ByteRecord;

use super::{
    CsvError, CsvOptions, Separator,
    head::looked_at,
    label::label,
    rows::{Rows, rewritten},
};
use crate::remark::{Code, Remarks};

/// What the marks of a number say.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Says {
    /// A number of at most three digits, and of more, without a mark.
    Short,
    Long,
    /// The decimal mark is this one.
    Decimal(u8),
    /// One mark before three digits: a decimal one, or of thousands.
    Either(u8),
}

/// Whether digits are such as `1 234` with any mark between.
pub(super) fn in_threes(whole: &[u8], mark: u8) -> bool {
    let mut groups = whole.split(|byte| *byte == mark);
    groups.next().is_some_and(|first| (1..=3).contains(&first.len()) && first[0] != b'0')
        && groups.all(|group| group.len() == 3)
}

pub(super) const fn other(mark: u8) -> u8 {
    if mark == b',' { b'.' } else { b',' }
}

/// A number without blanks between its thousands; a blank that does not break is one byte in old encodings.
fn unspaced(cell: &[u8]) -> Option<Cow<'_, [u8]>> {
    let blank = |byte: &u8| matches!(byte, b' ' | 0xa0);
    if !cell.iter().any(blank) {
        return Some(Cow::Borrowed(cell));
    }
    let whole = cell.iter().position(|byte| matches!(byte, b'.' | b',')).unwrap_or(cell.len());
    let digits = cell[..whole].strip_prefix(b"-").unwrap_or(&cell[..whole]);
    let plain: Vec<u8> = digits.iter().map(|byte| if blank(byte) { b' ' } else { *byte }).collect();
    let kept = || cell.iter().copied().filter(|byte| !blank(byte)).collect::<Vec<u8>>();
    in_threes(&plain, b' ').then(|| Cow::Owned(kept()))
}

/// What a cell says; `None` if it is no number.
fn says(cell: &[u8]) -> Option<Says> {
    let digits = cell.strip_prefix(b"-").or_else(|| cell.strip_prefix(b"+")).unwrap_or(cell);
    let (digits, has_power) = match digits.iter().position(|byte| matches!(byte, b'e' | b'E')) {
        Some(at) => (&digits[..at], true),
        None => (digits, false),
    };
    let marks = |byte: &u8| matches!(byte, b'.' | b',');
    if !digits.iter().any(u8::is_ascii_digit)
        || !digits.iter().all(|byte| byte.is_ascii_digit() || marks(byte))
    {
        return None;
    }
    let Some(at) = digits.iter().rposition(marks) else {
        return Some(if digits.len() > 3 || has_power { Says::Long } else { Says::Short });
    };
    let (whole, last, behind) = (&digits[..at], digits[at], digits.len() - at - 1);
    let same = whole.contains(&last);
    if whole.contains(&other(last)) {
        return (!same && in_threes(whole, other(last))).then_some(Says::Decimal(last));
    }
    if same {
        return in_threes(digits, last).then_some(Says::Decimal(other(last)));
    }
    let either = !has_power && behind == 3 && in_threes(digits, last);
    Some(if either { Says::Either(last) } else { Says::Decimal(last) })
}

/// What all cells of a column say.
#[derive(Debug, Clone, Default)]
struct Column {
    /// Cells whose decimal mark is certain, by mark: a point, a comma.
    certain: [u64; 2],
    /// Cells whose mark may be either, by mark.
    either: [u64; 2],
    has_short: bool,
    has_long: bool,
    has_blanks: bool,
}

const MARKS: [u8; 2] = [b'.', b','];

impl Column {
    fn note(&mut self, cell: &[u8]) {
        let Some(plain) = unspaced(cell) else { return };
        let index = |mark: u8| usize::from(mark == b',');
        match says(&plain) {
            None => return,
            Some(Says::Short) => self.has_short = true,
            Some(Says::Long) => self.has_long = true,
            Some(Says::Decimal(mark)) => self.certain[index(mark)] += 1,
            Some(Says::Either(mark)) => self.either[index(mark)] += 1,
        }
        self.has_blanks |= plain.len() < cell.len();
    }

    /// The decimal mark that is certain; an error if two are.
    fn certain(&self) -> Result<Option<u8>, ()> {
        match self.certain.map(|count| count > 0) {
            [true, true] => Err(()),
            [point, comma] => {
                Ok(MARKS.into_iter().zip([point, comma]).find_map(|(mark, is)| is.then_some(mark)))
            }
        }
    }

    /// The decimal mark, if any is needed to read the column, where others do not say: thousands stand beside numbers below.
    fn decimal(&self, in_mm: bool, rest: Option<u8>) -> Result<Option<u8>, ()> {
        let mark = match (self.certain()?, self.either.map(|count| count > 0)) {
            (Some(mark), _) => return Ok(Some(mark)),
            (None, [true, true]) => return Err(()),
            (None, [false, false]) => return Ok(None),
            (None, [point, _]) => {
                if point {
                    b'.'
                } else {
                    b','
                }
            }
        };
        let is_thousands = (self.has_short || in_mm) && !self.has_long && rest != Some(mark);
        Ok(Some(if is_thousands { other(mark) } else { mark }))
    }
}

/// The table with each number by its column's own marks, and how that is read; `None` if all columns are written alike, or
/// one is written in two ways. A decimal mark that the caller states holds but where columns differ.
pub(super) fn by_column(
    file: &str,
    text: &[u8],
    options: &CsvOptions,
    error: &CsvError,
    remarks: &mut Remarks,
) -> Option<(Vec<u8>, CsvOptions)> {
    let may =
        matches!(error, CsvError::NoNumbers { .. } | CsvError::NoStamps { .. } | CsvError::NoTime { .. });
    let found = looked_at(file, text, options);
    let (dialect, head) = found.filter(|(one, _)| may && one.separator != Separator::Space)?;
    let mut columns = vec![Column::default(); head.names.len()];
    let mut record = ByteRecord::new();
    let mut rows = Rows::new(text, dialect.separator);
    while let Some(line) = rows.next(&mut record) {
        let cells = record.iter().zip(&mut columns).filter(|_| line >= head.first_line);
        cells.for_each(|(cell, column)| column.note(cell.trim_ascii()));
    }
    let certain = columns.iter().map(Column::certain).collect::<Result<Vec<_>, _>>().ok()?;
    let mixed = MARKS.iter().all(|mark| certain.contains(&Some(*mark)));
    let one = certain.iter().flatten().next().copied().filter(|_| !mixed);
    let stated = options.decimal_comma.map(|comma| if comma { b',' } else { b'.' });
    if stated.is_some() && !mixed && one != stated {
        return None;
    }
    let in_mm = |name: &String| label(name, None).unit.is_some_and(|unit| unit.name == "mm");
    let decimals = head.names.iter().zip(&columns).map(|(name, column)| column.decimal(in_mm(name), one));
    let decimals = decimals.collect::<Result<Vec<Option<u8>>, _>>().ok()?;
    let target = if dialect.decimal_comma { b',' } else { b'.' };
    let has_thousands = |(column, decimal): (&Column, &Option<u8>)| {
        let index = usize::from(*decimal != Some(b','));
        decimal.is_some() && column.either[index] > 0 || column.has_blanks
    };
    let changed: Vec<&str> = (head.names.iter().zip(columns.iter().zip(&decimals)))
        .filter(|(_, (column, decimal))| {
            decimal.is_some_and(|mark| mark != target) || has_thousands((column, decimal))
        })
        .map(|(name, _)| name.as_str())
        .collect();
    if changed.is_empty() {
        return None;
    }
    let message = format!(
        "columns that write numbers otherwise than others do, or with marks between thousands: {}; each is read by all of its \
         own cells",
        changed.join(", ")
    );
    remarks.add(Code::Guessed, changed.len() as u64, message);
    let plain = rewritten(text, dialect.separator, |line, record, plain| {
        let cells = record.iter().enumerate().map(|(at, cell)| match decimals.get(at).copied() {
            Some(decimal) if line >= head.first_line => with_mark(cell, decimal, target),
            _ => Cow::Borrowed(cell),
        });
        plain.write_record(cells)
    });
    Some((plain?, dialect.rewritten(options)))
}

/// A number without marks between thousands and with the decimal mark `target`; any other cell as it is.
fn with_mark(cell: &[u8], decimal: Option<u8>, target: u8) -> Cow<'_, [u8]> {
    match unspaced(cell.trim_ascii()) {
        Some(plain) if says(&plain).is_some() => {
            let kept = plain.iter().filter(|byte| !MARKS.contains(byte) || Some(**byte) == decimal);
            Cow::Owned(kept.map(|byte| if Some(*byte) == decimal { target } else { *byte }).collect())
        }
        _ => Cow::Borrowed(cell),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str, options: &CsvOptions) -> Option<String> {
        let error = CsvError::NoJoints { why: String::new(), present: String::new() };
        assert!(by_column("a.csv", text.as_bytes(), options, &error, &mut Remarks::default()).is_none());
        let error = CsvError::NoTime { why: String::new(), present: String::new(), by_number: Vec::new() };
        let (text, _) = by_column("a.csv", text.as_bytes(), options, &error, &mut Remarks::default())?;
        Some(String::from_utf8(text).unwrap())
    }

    #[test]
    fn each_column_is_read_by_its_own_marks() {
        let open = CsvOptions::default();
        for (text, plain) in [
            ("t;q\n0,010;900\n0,020;1.150\n", "t;q\n0,010;900\n0,020;1150\n"),
            ("t,q\n0.010,900\n0.020,\"1,150\"\n", "t,q\n0.010,900\n0.020,1150\n"),
            ("t;q\n0,010;900,5\n0,020;1 150,5\n", "t;q\n0,010;900,5\n0,020;1150,5\n"),
            ("t,q\n10.010,\"900,00\"\n0.020,\"1.150,00\"\n", "t,q\n10.010,900.00\n0.020,1150.00\n"),
            ("t;q\n0,010;-1.150\n0,020;12,5\n", "t;q\n0,010;-1150\n0,020;12,5\n"),
        ] {
            assert_eq!(of(text, &open).as_deref(), Some(plain), "{text}");
        }
        for text in [
            "t;q\n0,010;1,5\n0,020;1,150\n", "t;q\n0,010;1,5\n0,020;1.5\n", "t,q\n0.010,1.5\n0.020,x\n",
            "t q\n0.010 1.5\n0.020 100 200\n",
        ] {
            assert_eq!(of(text, &open), None, "{text}");
        }
    }

    #[test]
    fn a_decimal_mark_that_is_stated_holds_but_where_columns_differ() {
        let comma = CsvOptions { decimal_comma: Some(true), ..CsvOptions::default() };
        assert_eq!(of("t;q\n0.010;900\n0.020;1,150\n", &comma), None);
        let german = "t;q\n0,010;900\n0,020;1.150\n";
        assert_eq!(of(german, &comma).as_deref(), Some("t;q\n0,010;900\n0,020;1150\n"));
        let mixed = "t,q,r\n10.010,\"900,00\",\"1,5\"\n0.020,\"1.150,00\",\"1,5\"\n";
        let plain = "t,q,r\n\"10,010\",\"900,00\",\"1,5\"\n\"0,020\",\"1150,00\",\"1,5\"\n";
        assert_eq!(of(mixed, &comma).as_deref(), Some(plain));
    }
}
