//! Tables with a unit behind each number, as boards of plots give them, become tables with the unit in the header.

use std::borrow::Cow;

use super::{
    CsvOptions,
    head::{Head, looked_at},
    number::{number, with_unit},
    rows::rewritten,
    unit::{Measure, Unit},
};

/// The text with plain numbers below headers that name the unit.
pub(super) fn without_units(file: &str, text: &[u8], options: &CsvOptions) -> Option<Vec<u8>> {
    let (dialect, head) = looked_at(file, text, options)?;
    let units: Vec<Option<Unit>> = (0..dialect.width).map(|column| unit_of(&head, column)).collect();
    units.iter().flatten().next()?;
    rewritten(text, dialect.separator, |line, record, plain| {
        let cells = record.iter().zip(units.iter().copied().chain(std::iter::repeat(None)));
        let cells = cells.map(|(cell, unit)| match unit {
            Some(unit) if line == head.line => {
                let mut name = cell.to_vec();
                name.extend_from_slice(format!(" [{}]", unit.name).as_bytes());
                Cow::Owned(name)
            }
            Some(unit) if line >= head.first_line => in_unit(cell, unit, dialect.decimal_comma),
            _ => Cow::Borrowed(cell),
        });
        plain.write_record(cells)
    })
}

/// The first unit of a column in which most cells have one. Times are read with theirs.
fn unit_of(head: &Head, column: usize) -> Option<Unit> {
    let cells =
        head.sample.iter().filter_map(|row| row.get(column)).filter(|cell| !cell.trim_ascii().is_empty());
    let units: Vec<Option<Unit>> = cells.map(|cell| with_unit(cell).map(|(_, unit)| unit)).collect();
    let first = units.iter().flatten().next().filter(|unit| unit.measure != Measure::Time)?;
    let alike = units.iter().flatten().filter(|unit| unit.measure == first.measure).count();
    (head.named && 2 * alike > units.len()).then_some(*first)
}

/// The number of a cell in a unit; the cell itself if it has another kind of unit.
fn in_unit(cell: &[u8], unit: Unit, decimal_comma: bool) -> Cow<'_, [u8]> {
    match with_unit(cell) {
        Some((digits, own)) if own == unit => Cow::Borrowed(digits),
        Some((digits, own)) if own.measure == unit.measure && unit.measure != Measure::Other => {
            let value = number(digits, decimal_comma).map(|value| value * own.factor / unit.factor);
            let text = value.map(|value| value.to_string());
            let text = text.map(|text| if decimal_comma { text.replace('.', ",") } else { text });
            text.map_or(Cow::Borrowed(cell), |text| Cow::Owned(text.into_bytes()))
        }
        _ => Cow::Borrowed(cell),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> String {
        let plain = without_units("a.csv", text.as_bytes(), &CsvOptions::default());
        plain.map_or(text.to_owned(), |plain| String::from_utf8(plain).unwrap())
    }

    #[test]
    fn units_behind_numbers_go_to_the_header() {
        assert_eq!(
            of("Time,boom set,boom act\n0 s,20.0 mm,20 mm\n1 s,1.50 m,\n2 s,30 mm,25 mm\n"),
            "Time,boom set [mm],boom act [mm]\n0 s,20.0,20\n1 s,1500,\n2 s,30,25\n"
        );
        assert_eq!(
            of("t;q set;note\n0,0;1,5\u{b0};a\n1,0;2,5\u{b0};b\n"),
            "t;q set [deg];note\n0,0;1,5;a\n1,0;2,5;b\n"
        );
    }

    #[test]
    fn other_tables_stay() {
        for text in ["t,q\n0,1\n1,2\n", "t,q,n\n0,1,lift 3\n1,2,lift 4\n", "0,1 mm\n1,2 mm\n"] {
            assert_eq!(of(text), text);
        }
    }
}
