//! Numbers as files write them, with a decimal point or a decimal comma.

use super::{
    date::{names_month, of_plc},
    elapsed::elapsed_ns,
    rows::cell_text,
    scale::unit_named,
    unit::Unit,
};
use crate::units::whole_ns;

/// A number near zero without an exponent has some 345 characters, and `export` writes those.
const LONGEST: usize = 400;

/// The number in a cell; `None` if it is none. NaN and infinities, which some programs write as
/// words, are numbers here. The other mark may set thousands apart before the decimal mark.
pub(super) fn number(cell: &[u8], decimal_comma: bool) -> Option<f64> {
    let cell = cell.trim_ascii();
    if cell.is_empty() || cell.len() > LONGEST {
        return None;
    }
    let (decimal, group) = if decimal_comma { (b',', b'.') } else { (b'.', b',') };
    let grouped = memchr::memchr(group, cell).is_some();
    if !decimal_comma && !grouped {
        return std::str::from_utf8(cell).ok()?.parse().ok();
    }
    let Some(mark) = memchr::memrchr(decimal, cell) else {
        // Alone, the other mark may be a decimal mark, too.
        return if grouped { None } else { std::str::from_utf8(cell).ok()?.parse().ok() };
    };
    let mut buffer = [0_u8; LONGEST];
    let (whole, part) = cell.split_at(mark);
    let mut length = 0;
    let mut put = |byte: u8| {
        buffer[length] = byte;
        length += 1;
    };
    match memchr::memchr(group, whole) {
        None => whole.iter().for_each(|byte| put(*byte)),
        Some(_) => ungrouped(whole, group)?.for_each(&mut put),
    }
    put(b'.');
    part.iter().skip(1).for_each(|byte| put(*byte));
    std::str::from_utf8(buffer.get(..length)?).ok()?.parse().ok()
}

/// The digits of a whole number whose thousands are set apart by a mark, with its sign: `-1.234.567`; `None` if they are
/// not groups of three.
fn ungrouped(whole: &[u8], mark: u8) -> Option<impl Iterator<Item = u8>> {
    let digits = whole.strip_prefix(b"-").or_else(|| whole.strip_prefix(b"+")).unwrap_or(whole);
    let grouped = digits.split(|byte| *byte == mark).enumerate().all(|(k, group)| {
        let long = if k == 0 { (1..=3).contains(&group.len()) } else { group.len() == 3 };
        long && group.iter().all(u8::is_ascii_digit)
    });
    grouped.then(|| whole.iter().copied().filter(move |byte| *byte != mark))
}

/// As [`nanoseconds_after`], from 0 on.
pub(super) fn nanoseconds(cell: &[u8], decimal_comma: bool, unit_ns: i64) -> Option<i64> {
    nanoseconds_after(0, cell, decimal_comma, unit_ns)
}

/// An instant and a plain decimal number times `unit_ns` after it, rounded to whole nanoseconds without a detour over
/// binary fractions: stamps of 19 digits keep them all. `None` beyond what an `i64` holds.
pub(super) fn nanoseconds_after(
    zero_ns: i128,
    cell: &[u8],
    decimal_comma: bool,
    unit_ns: i64,
) -> Option<i64> {
    let cell = cell.trim_ascii();
    let (negative, digits) = match cell.first()? {
        b'-' => (true, &cell[1..]),
        b'+' => (false, &cell[1..]),
        _ => (false, cell),
    };
    let mark = if decimal_comma { b',' } else { b'.' };
    let (whole, fraction) = match memchr::memchr(mark, digits) {
        Some(at) => (&digits[..at], &digits[at + 1..]),
        None => (digits, &[][..]),
    };
    let plain = |digits: &[u8]| digits.iter().all(u8::is_ascii_digit);
    if !plain(whole) || !plain(fraction) {
        return scientific(cell, decimal_comma, unit_ns)
            .and_then(|ns| i64::try_from(zero_ns + i128::from(ns)).ok());
    }
    if whole.len() > 19 || whole.is_empty() && fraction.is_empty() {
        return None;
    }
    let value = |digits: &[u8]| digits.iter().fold(0_i128, |sum, digit| sum * 10 + i128::from(digit - b'0'));
    // More digits than these are far below a nanosecond.
    let fraction = fraction.get(..18).unwrap_or(fraction);
    let unit = i128::from(unit_ns);
    let scale = 10_i128.pow(u32::try_from(fraction.len()).ok()?);
    let rounded = (2 * value(fraction) * unit + scale) / (2 * scale);
    let total = value(whole) * unit + rounded;
    i64::try_from(zero_ns + if negative { -total } else { total }).ok()
}

fn scientific(cell: &[u8], decimal_comma: bool, unit_ns: i64) -> Option<i64> {
    whole_ns(number(cell, decimal_comma)? * unit_ns as f64)
}

/// The number of a cell and the unit behind it: `20.0 mm`.
pub(super) fn with_unit(cell: &[u8]) -> Option<(&[u8], Unit)> {
    let cell = cell.trim_ascii();
    let end = cell.iter().rposition(u8::is_ascii_digit)? + 1;
    let (digits, behind) = cell.split_at(end);
    let plain = |digits: &[u8]| number(digits, false).is_some() || number(digits, true).is_some();
    let unit = unit_named(&cell_text(behind)).filter(|_| !behind.is_empty())?;
    plain(digits).then_some((digits, unit))
}

/// The kind of a cell, before the file's decimal mark is known.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Looks {
    Empty,
    Whole,
    Point,
    Comma,
    Date,
    Text,
}

/// Whether a cell says that there was no number, as a sensor does that is not up yet.
pub(super) fn says_absent(cell: &[u8]) -> bool {
    const WORDS: [&[u8]; 17] = [
        b"nan", b"inf", b"-inf", b"na", b"n/a", b"#n/a", b"null", b"none", b"-", b"--", b"---", b"***",
        b"bad", b"no data", b"1.#qnan", b"1.#ind", b"-1.#ind",
    ];
    WORDS.iter().any(|word| cell.trim_ascii().eq_ignore_ascii_case(word))
}

pub(super) fn looks(cell: &[u8]) -> Looks {
    let cell = cell.trim_ascii();
    if cell.is_empty() {
        return Looks::Empty;
    }
    let has = |byte| memchr::memchr(byte, cell).is_some();
    match (number(cell, false), number(cell, true)) {
        (Some(_), _) if has(b'.') => Looks::Point,
        (_, Some(_)) if has(b',') => Looks::Comma,
        (Some(_), _) | (_, Some(_)) => Looks::Whole,
        (None, None) => {
            let spans = cell[0].eq_ignore_ascii_case(&b't') || has(b':');
            if spans && std::str::from_utf8(cell).ok().and_then(elapsed_ns).is_some() {
                return Looks::Date;
            }
            if let Some((digits, _)) = with_unit(cell) {
                return looks(digits);
            }
            let cell = std::str::from_utf8(cell).map_or(cell, |text| of_plc(text).as_bytes());
            let dated = cell.len() >= 8
                && cell[0].is_ascii_digit()
                && (has(b':') || !has(b';') && !has(b','))
                && memchr::memchr_iter(b',', cell).count() < 2
                && cell.iter().all(|byte| byte.is_ascii_digit() || b" -:./,;TZ+APMUC".contains(byte));
            let named = || std::str::from_utf8(cell).is_ok_and(names_month);
            if dated || named() { Looks::Date } else { Looks::Text }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_mark_sets_thousands_apart_only_before_the_other_and_only_in_threes() {
        for (cell, value) in [("1,493.02", 1493.02), ("-1,234,567.5", -1_234_567.5)] {
            assert_eq!(number(cell.as_bytes(), false), Some(value), "{cell}");
            assert_eq!(looks(cell.as_bytes()), Looks::Point, "{cell}");
        }
        for cell in ["1,49.02", "1493,020.5", "1,493", "1.493,02", ",493.0"] {
            assert_eq!(number(cell.as_bytes(), false), None, "{cell}");
        }
        for (cell, value) in [("1.493,02", 1493.02), ("-1.234.567,5", -1_234_567.5), ("+12.000,0", 12_000.0)]
        {
            assert_eq!(number(cell.as_bytes(), true), Some(value), "{cell}");
            assert_eq!(looks(cell.as_bytes()), Looks::Comma, "{cell}");
        }
        for cell in ["1.49,02", "1493.020,5", "1,493.02", ".493,0", "1..493,0", "1.493"] {
            assert_eq!(number(cell.as_bytes(), true), None, "{cell}");
        }
        assert_eq!(nanoseconds(b"1.493,02", true, 1_000_000_000), Some(1_493_020_000_000));
    }

    #[test]
    fn a_stamp_of_nineteen_digits_keeps_them() {
        assert_eq!(nanoseconds(b"1750000000123456789", false, 1), Some(1_750_000_000_123_456_789));
        assert_eq!(
            nanoseconds(b"1750000000.123456789", false, 1_000_000_000),
            Some(1_750_000_000_123_456_789)
        );
        assert_eq!(nanoseconds(b"-0,02", true, 1_000_000_000), Some(-20_000_000));
        assert_eq!(nanoseconds(b"0.30000000000000004", false, 1_000_000_000), Some(300_000_000));
        assert_eq!(nanoseconds(b"1.5e-3", false, 1_000_000_000), Some(1_500_000));
        assert_eq!(nanoseconds(b"99999999999", false, 1_000_000_000), None);
    }

    #[test]
    fn every_number_reads_back_as_it_is_printed() {
        for value in [f64::MIN_POSITIVE, -5e-324, f64::MAX, -2.235_291_569_183_627e-31, 0.1, -0.0] {
            let cell = format!("{value}");
            assert_eq!(number(cell.as_bytes(), false).map(f64::to_bits), Some(value.to_bits()), "{cell}");
            let cell = cell.replace('.', ",");
            assert_eq!(number(cell.as_bytes(), true).map(f64::to_bits), Some(value.to_bits()), "{cell}");
        }
    }

    #[test]
    fn a_point_is_no_number_where_the_comma_is_decimal() {
        assert_eq!(number(b" 1,5 ", true), Some(1.5));
        assert_eq!(number(b"1.5", true), None);
        assert_eq!(number(b"1.23,5", true), None);
        assert_eq!(number(b"1,5", false), None);
        assert_eq!(number(b"-1e3", true), Some(-1000.0));
    }

    #[test]
    fn dates_are_told_from_words() {
        assert_eq!(looks(b"15.06.2025 15:06:40,020"), Looks::Date);
        assert_eq!(looks(b"2025-06-15T15:06:40Z"), Looks::Date);
        assert_eq!(looks(b"31-Aug-2024 10:59:50.010"), Looks::Date);
        assert_eq!(looks(b"Sat Aug 31 10:59:50 2024"), Looks::Date);
        assert_eq!(looks(b"arm: may 1"), Looks::Text);
        assert_eq!(looks(b"standstill"), Looks::Text);
        assert_eq!(looks(b"1,25"), Looks::Comma);
        assert_eq!(looks(b"T#1s10ms"), Looks::Date);
        assert_eq!(looks("-1.5\u{b0}".as_bytes()), Looks::Point);
        assert_eq!(looks(b"20 mm"), Looks::Whole);
        assert_eq!(looks(b"joint 1"), Looks::Text);
        assert_eq!(looks(b"000;900;1.150"), Looks::Text);
        assert_eq!(looks(b"0.000,0.5,0.1,0"), Looks::Text);
    }
}
