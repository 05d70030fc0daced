//! Tables as databases print them and Markdown has them, with bars between cells and a rule below the header.

use super::{
    Separator,
    number::{Looks, looks},
    rows::writer,
};

/// The rows of a printed table, separated by tabs; `None` unless the text is one.
pub(super) fn as_table(text: &[u8]) -> Option<Vec<u8>> {
    const LOOKED_AT: usize = 100;
    if !text.split(|byte| *byte == b'\n').take(LOOKED_AT).any(|line| is_rule(line.trim_ascii())) {
        return None;
    }
    let lines: Vec<&[u8]> = text.split(|byte| *byte == b'\n').map(<[u8]>::trim_ascii).collect();
    // The first rule may stand above the header, too.
    let rule = (1..lines.len()).find(|&at| is_rule(lines[at]) && bars(lines[at - 1]) > 0)?;
    let header = lines[rule - 1];
    let above = lines[..rule - 1].iter().any(|line| bars(line) > 0 && !is_rule(line));
    let named = cells(header).all(|cell| matches!(looks(cell), Looks::Text | Looks::Empty));
    let below = lines[rule + 1..].iter().take_while(|line| bars(line) > 0 || is_rule(line));
    let rows: Vec<&[u8]> = below.copied().filter(|line| !is_rule(line)).collect();
    let after = lines.get(rule + 1..)?.iter().skip_while(|line| bars(line) > 0 || is_rule(line));
    let several = after.clone().any(|line| is_rule(line));
    let one = bars(lines[rule]) == bars(header) && rows.iter().all(|row| bars(row) == bars(header));
    if rows.is_empty() || several || above || !named || !one {
        return None;
    }
    let mut out = writer(Separator::Byte(b'\t'));
    for row in std::iter::once(header).chain(rows) {
        out.write_record(cells(row)).ok()?;
    }
    out.into_inner().ok()
}

/// Whether a line is a rule between rows: `----+----`, `+---+---+` or `|---:|:---|`.
pub(in crate::log) fn is_rule(line: &[u8]) -> bool {
    const LEAST: usize = 3;
    let dashes = memchr::memchr_iter(b'-', line).count();
    line.iter().all(|byte| b"-+|: ".contains(byte))
        && dashes >= LEAST
        && memchr::memchr2(b'|', b'+', line).is_some()
}

/// The number of bars between cells, without those at the ends.
fn bars(line: &[u8]) -> usize {
    let marks: &[u8] = if is_rule(line) { b"|+" } else { b"|" };
    inner(line, marks).iter().filter(|byte| marks.contains(byte)).count()
}

/// A line without the marks at its ends.
fn inner<'a>(line: &'a [u8], marks: &[u8]) -> &'a [u8] {
    let line = line.trim_ascii();
    let line = line.split_first().filter(|(first, _)| marks.contains(first)).map_or(line, |(_, rest)| rest);
    line.split_last().filter(|(last, _)| marks.contains(last)).map_or(line, |(_, rest)| rest)
}

fn cells(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    inner(line, b"|").split(|byte| *byte == b'|').map(<[u8]>::trim_ascii)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> Option<String> {
        as_table(text.as_bytes()).map(|text| String::from_utf8(text).unwrap())
    }

    #[test]
    fn other_texts_two_tables_and_rows_of_other_widths_are_left() {
        for text in [
            "t|q\n0|1\n1|2\n",
            "t|q|r\n0|1|2\n-|-|-\n1|2|3\n",
            "0|1|2\n-|-|-\n1|2|3\n",
            "a\n---\nb\n",
            "t | q\n--+--\n0 | 1\n1 | 2 | 3\n",
            "t | q\n--+--\n",
            "t | q\n--+--\n0 | 1\n\nt | r\n--+--\n0 | 1\n",
            "",
        ] {
            assert_eq!(of(text), None, "{text}");
        }
    }
}
