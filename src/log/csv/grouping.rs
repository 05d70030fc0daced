//! Numbers whose thousands are set apart, without these marks.

use std::borrow::Cow;

use super::{
    CsvOptions, Separator,
    dialect::Dialect,
    head::looked_at,
    label::label,
    marks::{in_threes, other},
    number::{Looks, looks},
    rows::rewritten,
};
use crate::remark::{Code, Remarks};

/// Marks between groups of three that are no decimal marks, as UTF-8: apostrophes and blanks of several widths.
const MARKS: [&[u8]; 5] = [
    "'".as_bytes(),
    "\u{2019}".as_bytes(),
    "\u{a0}".as_bytes(),
    "\u{202f}".as_bytes(),
    "\u{2009}".as_bytes(),
];
/// The sign that typesetters put before negative numbers.
const MINUS: &[u8] = "\u{2212}".as_bytes();

/// The text with plain numbers.
pub(super) fn plain<'a>(
    file: &str,
    text: Cow<'a, [u8]>,
    options: &CsvOptions,
    remarks: &mut Remarks,
) -> Cow<'a, [u8]> {
    let text = without_marks(&text).map_or(text, Cow::Owned);
    let Some((dialect, mark, columns)) = grouped(file, &text, options, remarks) else { return text };
    without_groups(&text, dialect, mark, &columns).map_or(text, Cow::Owned)
}

/// Without marks that can only set thousands apart, between a digit and three others; `None` if there are none.
fn without_marks(text: &[u8]) -> Option<Vec<u8>> {
    let mut plain = Vec::new();
    let mut from = 0;
    let three = |rest: &[u8]| {
        rest.get(..3).is_some_and(|three| three.iter().all(u8::is_ascii_digit))
            && !rest.get(3).is_some_and(u8::is_ascii_digit)
    };
    for at in memchr::memchr3_iter(b'\'', 0xc2, 0xe2, text) {
        let rest = &text[at..];
        let mark = MARKS.iter().find(|mark| {
            let before = at.checked_sub(1).and_then(|before| text.get(before));
            rest.starts_with(mark) && before.is_some_and(u8::is_ascii_digit) && three(&rest[mark.len()..])
        });
        let put: Option<(usize, &[u8])> = match mark {
            Some(mark) => Some((mark.len(), b"")),
            None if rest.starts_with(MINUS) => Some((MINUS.len(), b"-")),
            None => None,
        };
        if let Some((length, put)) = put {
            plain.extend_from_slice(&text[from..at]);
            plain.extend_from_slice(put);
            from = at + length;
        }
    }
    (from > 0).then(|| {
        plain.extend_from_slice(&text[from..]);
        plain
    })
}

/// How the digits of a cell are set apart by a mark.
#[derive(PartialEq)]
enum Groups {
    /// In groups of three, as thousands are, and with a decimal mark behind: that is certain.
    WithDecimals,
    /// In groups of three, as thousands are, or as three decimals are.
    Perhaps,
    /// A whole number of at most three digits, and of more.
    Short,
    Long,
    /// With the mark otherwise.
    Decimal,
    /// With the other mark alone.
    Other,
}

fn groups(cell: &[u8], mark: u8) -> Option<Groups> {
    let cell = cell.trim_ascii();
    let digits = cell.strip_prefix(b"-").or_else(|| cell.strip_prefix(b"+")).unwrap_or(cell);
    let other = other(mark);
    let numeric = |byte: &u8| byte.is_ascii_digit() || *byte == mark || *byte == other;
    if digits.is_empty() || !digits.iter().all(numeric) || !digits[0].is_ascii_digit() {
        return None;
    }
    let (whole, decimals) = match digits.iter().position(|byte| *byte == other) {
        Some(at) => (&digits[..at], Some(&digits[at + 1..])),
        None => (digits, None),
    };
    if !whole.contains(&mark) {
        return Some(match decimals {
            Some(_) => Groups::Other,
            None if whole.len() > 3 => Groups::Long,
            None => Groups::Short,
        });
    }
    let in_threes = in_threes(whole, mark);
    let plain = decimals.is_none_or(|decimals| decimals.iter().all(u8::is_ascii_digit));
    let several = memchr::memchr(mark, whole) != memchr::memrchr(mark, whole);
    Some(match (in_threes && plain, decimals.is_some() || several) {
        (true, true) => Groups::WithDecimals,
        (true, false) => Groups::Perhaps,
        (false, _) => Groups::Decimal,
    })
}

/// Whether commas separate cells, and numbers in quotes have a comma that sets no thousands apart: a decimal one.
pub(super) fn has_quoted_commas(file: &str, text: &[u8], options: &CsvOptions) -> bool {
    let found = looked_at(file, text, options);
    let Some((_, head)) = found.filter(|one| one.0.separator == Separator::Byte(b',')) else { return false };
    let cells = || head.sample.iter().flatten();
    let decimal =
        |cell: &Vec<u8>| memchr::memchr(b',', cell).is_some() && groups(cell, b',') == Some(Groups::Decimal);
    let open = options.decimal_comma.is_none();
    open && cells().any(decimal) && !cells().any(|cell| looks(cell) == Looks::Point)
}

/// The mark that sets thousands apart, if one does. `1.380` may be either: it is thousands where the column has whole
/// numbers below a thousand, too, or is in millimetres, and no number of the file says otherwise. With the columns that may
/// have it.
fn grouped(
    file: &str,
    text: &[u8],
    options: &CsvOptions,
    remarks: &mut Remarks,
) -> Option<(Dialect, u8, Vec<bool>)> {
    let (dialect, head) = looked_at(file, text, options)?;
    let cells = |column: usize| head.sample.iter().filter_map(move |row| row.get(column)).map(Vec::as_slice);
    for mark in [b',', b'.'] {
        let (mut certain, mut perhaps, mut decimal) = (false, None, false);
        let mut columns = Vec::new();
        for (column, name) in head.names.iter().enumerate() {
            let found: Vec<Groups> = cells(column).filter_map(|cell| groups(cell, mark)).collect();
            certain |= found.contains(&Groups::WithDecimals);
            columns.push(!found.contains(&Groups::Decimal));
            let has_decimals = found.contains(&Groups::Decimal) || found.contains(&Groups::Other);
            decimal |= has_decimals && !found.contains(&Groups::WithDecimals);
            if found.contains(&Groups::Perhaps) {
                let short = found.contains(&Groups::Short);
                // No cylinder is ten metres long.
                let below_ten = |cell: &[u8]| {
                    let digits = cell.trim_ascii().strip_prefix(b"-").unwrap_or(cell.trim_ascii());
                    digits.iter().position(|byte| *byte == mark).is_none_or(|at| at < 2)
                };
                let millimetres = label(name, None).unit.is_some_and(|unit| unit.name == "mm")
                    && cells(column).all(below_ten);
                // All columns must allow it.
                let allowed = (short || millimetres) && !found.contains(&Groups::Long);
                perhaps = Some(perhaps.unwrap_or(true) && allowed);
            }
        }
        if certain && options.decimal_comma != Some(mark == b',') {
            return Some((dialect, mark, columns));
        }
        if perhaps == Some(true) && !decimal && options.decimal_comma.is_none() {
            let mark_name = if mark == b',' { "commas" } else { "points" };
            let message = format!(
                "{mark_name} between numbers such as 1{0}380 are taken to set thousands apart; if they are decimal \
                 marks, say --decimal-{1}",
                char::from(mark),
                if mark == b',' { "comma" } else { "point" }
            );
            remarks.add(Code::Guessed, 1, message);
            return Some((dialect, mark, columns));
        }
    }
    None
}

/// The same table with each cell of grouped digits without the mark, in columns that may have it.
fn without_groups(text: &[u8], dialect: Dialect, mark: u8, columns: &[bool]) -> Option<Vec<u8>> {
    let may = |at: usize| columns.get(at).copied().unwrap_or(false);
    rewritten(text, dialect.separator, |_, record, plain| {
        let cells = record.iter().enumerate().map(|(at, cell)| match groups(cell, mark) {
            Some(Groups::WithDecimals | Groups::Perhaps) if may(at) => {
                Cow::Owned(cell.iter().copied().filter(|byte| *byte != mark).collect::<Vec<u8>>())
            }
            _ => Cow::Borrowed(cell),
        });
        plain.write_record(cells)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> (String, usize) {
        let mut remarks = Remarks::default();
        let plain = plain("a.csv", Cow::Borrowed(text.as_bytes()), &CsvOptions::default(), &mut remarks);
        (String::from_utf8(plain.into_owned()).unwrap(), remarks.as_slice().len())
    }

    #[test]
    fn thousands_lose_their_marks_where_these_can_be_nothing_else() {
        assert_eq!(
            of("t,q\n0,1'180.5\n1,\u{2212}1\u{202f}180.5\n"),
            ("t,q\n0,1180.5\n1,-1180.5\n".into(), 0)
        );
        assert_eq!(of("t,q\n0.0,\"1,480.0\"\n0.5,\"980.5\"\n"), ("t,q\n0.0,1480.0\n0.5,980.5\n".into(), 0));
        let mixed = "t,q\n0.010,\"1.150,00\"\n10.010,\"1.150,00\"\n";
        assert_eq!(of(mixed), ("t,q\n0.010,\"1150,00\"\n10.010,\"1150,00\"\n".into(), 0));
        assert_eq!(of("t;q\n0;999\n1;1.000\n2;1.001\n"), ("t;q\n0;999\n1;1000\n2;1001\n".into(), 1));
        assert_eq!(of("t;q [mm]\n0;1,380\n1;1,381\n"), ("t;q [mm]\n0;1380\n1;1381\n".into(), 1));
    }

    #[test]
    fn decimals_stay() {
        for text in [
            "t;q [m]\n0;1,380\n1;1,381\n", "t;q [mm]\n0,000;1,380\n0,010;1,381\n",
            "t,q [deg]\n0,1.380\n1,1.381\n", "t;q [mm]\n0;1.380\n1;1.38\n",
            "t;q [mm]\n0;12,000\n20;12,003\n", "t;q\n0;it's 1\n1;2\n",
        ] {
            assert_eq!(of(text), (text.to_owned(), 0));
        }
    }

    #[test]
    fn a_comma_in_quotes_is_a_decimal_mark_where_it_sets_no_thousands_apart() {
        let quoted = |text: &str| has_quoted_commas("a.csv", text.as_bytes(), &CsvOptions::default());
        assert!(quoted("t,a,b\n\"0,0\",\"1,5\",2\n\"0,1\",\"1,6\",2\n"));
        for text in [
            "t,a,b\n1,\"1,500\",2\n2,\"1,600\",2\n", "t,a,b\n0.5,\"1,5\",2\n1.5,\"1,6\",2\n",
            "t;a;b\n0,0;1,5;2\n0,1;1,6;2\n", "t,a,b\n0,1,2\n",
        ] {
            assert!(!quoted(text), "{text}");
        }
    }
}
