//! Negative numbers in parentheses, as accountants write them: `(10,5)` is -10.5 where the comma is the decimal mark.

use std::collections::BTreeMap;

use super::{
    CsvError, CsvOptions,
    dialect::detect,
    number::number,
    rows::{cell_text, rewritten},
};

/// What the cells of a column were so far.
#[derive(Default)]
struct Seen {
    numbers: bool,
    /// The first cell of several numbers in parentheses, and its line.
    several: Option<(u64, String)>,
}

/// The table with a sign before such numbers; `None` where there are none. Several numbers in parentheses are a vector, and an error
/// where their column has single ones, too.
pub(super) fn signed(file: &str, text: &[u8], options: &CsvOptions) -> Result<Option<Vec<u8>>, CsvError> {
    let number_behind =
        |at: usize| text.get(at + 1).is_some_and(|byte| byte.is_ascii_digit() || b"., ".contains(byte));
    let opens = memchr::memchr_iter(b'(', text).any(number_behind);
    let Some(dialect) = opens.then(|| detect(file, text, options).ok()).flatten() else { return Ok(None) };
    let (mut columns, mut names) = (BTreeMap::<usize, Seen>::new(), Vec::new());
    let mut found = false;
    let signed = rewritten(text, dialect.separator, |line, record, out| {
        if names.is_empty() && record.len() == dialect.width {
            names = record.iter().map(cell_text).collect();
        }
        for (at, cell) in record.iter().enumerate() {
            let inner = within(cell);
            let value =
                number(inner.unwrap_or(cell), dialect.decimal_comma).filter(|value| value.is_finite());
            let is_vector = inner.is_some_and(|inner| value.is_none() && are_numbers(inner));
            if is_vector || value.is_some() {
                let seen = columns.entry(at).or_default();
                seen.numbers |= value.is_some();
                if is_vector && seen.several.is_none() {
                    seen.several = Some((line, cell_text(cell)));
                }
            }
            match inner.filter(|inner| value.is_some() && inner.first() != Some(&b'-')) {
                Some(inner) => {
                    found = true;
                    out.write_field([b"-", inner].concat())?;
                }
                None => out.write_field(cell)?,
            }
        }
        out.write_record(None::<&[u8]>)
    });
    for (at, seen) in columns {
        if let Some((line, cell)) = seen.several.filter(|_| seen.numbers) {
            let column = names.get(at).cloned().unwrap_or_default();
            let decimal = if dialect.decimal_comma { "comma" } else { "point" };
            return Err(CsvError::Parentheses { column, line, cell, decimal });
        }
    }
    Ok(signed.filter(|_| found))
}

/// What stands in the parentheses that hold a whole cell.
fn within(cell: &[u8]) -> Option<&[u8]> {
    Some(cell.trim_ascii().strip_prefix(b"(")?.strip_suffix(b")")?.trim_ascii())
}

fn are_numbers(inner: &[u8]) -> bool {
    let items = inner.split(|byte| *byte == b',' || byte.is_ascii_whitespace());
    let mut items = items.filter(|item| !item.is_empty()).peekable();
    items.peek().is_some() && items.all(|item| number(item, false).is_some())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> Option<String> {
        let signed = signed("a.csv", text.as_bytes(), &CsvOptions::default()).unwrap();
        signed.map(|text| String::from_utf8(text).unwrap())
    }

    #[test]
    fn one_number_in_parentheses_is_negative_and_several_are_a_vector() {
        assert_eq!(of("t;q\n0,0;(10,50)\n0,1;9,5\n").as_deref(), Some("t;q\n0,0;-10,50\n0,1;9,5\n"));
        assert_eq!(
            of("t,q\n0.0,(10.5)\n0.1,\"(1,234.5)\"\n").as_deref(),
            Some("t,q\n0.0,-10.5\n0.1,\"-1,234.5\"\n")
        );
        for text in
            ["t,q\n0,\"(1, 2, 3)\"\n", "t;q\n0.1;(1,2)\n", "t,q\n0,\"(0.2,)\"\n", "t,q (deg)\n0,(bad)\n"]
        {
            assert_eq!(of(text), None, "{text}");
        }
        let error =
            signed("a.csv", b"t;q\n0.1;1.5\n0.2;(3,5)\n", &CsvOptions::default()).unwrap_err().to_string();
        assert!(error.contains("\"q\"") && error.contains("(3,5)") && error.contains("line 3"), "{error}");
    }
}
