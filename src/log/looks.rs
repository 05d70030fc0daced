//! What a file looks like by its first bytes.

use std::path::Path;

use super::{
    csv::{begins_with_message, is_named_values, is_rule, of_lines},
    file::Span,
};

/// As much of a file as tells what it is if it is no log.
pub(super) const LOOKED_AT: Span = Span { start: 0, end: 4096 };

/// Marks that begin text in UTF-16.
const MARKS_OF_WIDE_TEXT: [&[u8]; 2] = [b"\xff\xfe", b"\xfe\xff"];

/// Whether the first bytes of a file are text whose first or last lines are split alike, or text of a file named as a table.
pub(super) fn is_table(path: &Path, bytes: &[u8]) -> bool {
    const LINES: usize = 3;
    if MARKS_OF_WIDE_TEXT.iter().any(|mark| bytes.starts_with(mark)) {
        return true;
    }
    // A recording that ends in zeros lost its power.
    let end = bytes.iter().rposition(|byte| *byte != 0).map_or(0, |last| last + 1);
    let bytes = of_lines(bytes[..end].into());
    let text = String::from_utf8_lossy(&bytes);
    if text.trim().is_empty() || text.chars().any(|c| c.is_control() && !c.is_whitespace()) {
        return false;
    }
    let named = path.extension().is_some_and(|ending| {
        ["csv", "tsv", "lvm", "jsonl", "ndjson"].iter().any(|one| ending.eq_ignore_ascii_case(one))
    });
    let lines: Vec<&str> =
        text.lines().filter(|line| !line.trim().is_empty() && !line.starts_with('#')).collect();
    // Below other lines a table has its own; the very last may be cut.
    let last = lines.len().saturating_sub(LINES + 1);
    let alike = |separator: char, lines: &[&str]| {
        let mut counts = lines.iter().take(LINES).map(|line| line.matches(separator).count());
        let first = counts.next().unwrap_or_default();
        lines.len() >= LINES && first > 0 && counts.all(|count| count == first)
    };
    let numbers = |separator: char, line: &&str| {
        let cells: Vec<&str> = line.split(separator).map(str::trim).filter(|cell| !cell.is_empty()).collect();
        let known = cells.iter().filter(|cell| cell.replace(',', ".").parse::<f64>().is_ok()).count();
        2 * known > cells.len()
    };
    let below = |one: char| {
        let lines = &lines[last..];
        alike(one, lines) && lines.iter().take(LINES).all(|line| numbers(one, line))
    };
    // An object a line, the last of which may be cut.
    let objects =
        lines.len() > 1 && lines.iter().take(2).all(|line| line.starts_with('{') && line.ends_with('}'));
    // Or all of them in a list.
    let list = text.trim_start().strip_prefix('[').is_some_and(|rest| rest.trim_start().starts_with('{'));
    let printed = || lines.windows(2).any(|two| is_rule(two[1].trim().as_bytes()) && two[0].contains('|'));
    named
        || objects
        || list
        || printed()
        || is_named_values(&text)
        || begins_with_message(&text)
        || [';', ',', '\t'].into_iter().any(|one| alike(one, &lines) || below(one))
        || spaced(&lines[last..])
}

/// Whether the first bytes of a file are those of a JSON document that may hold a table, and which this program did not write.
pub(super) fn is_document(path: &Path, bytes: &[u8]) -> bool {
    let named = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("json"));
    let own = bytes.starts_with(b"{\n  \"format\": \"hydrotrace.");
    let text = String::from_utf8_lossy(bytes);
    let lists = text.contains('[') || text.contains("{\"0\":");
    let mut marks = text.split_whitespace().flat_map(str::chars);
    let opens = [marks.next(), marks.next()];
    named && !own && (opens[0] == Some('{') && lists || opens == [Some('['); 2])
}

/// Whether lines are numbers between blanks, as many in each.
fn spaced(lines: &[&str]) -> bool {
    const LINES: usize = 3;
    const LEAST_CELLS: usize = 2;
    let cells = |line: &&str| {
        let mut cells = line.split_whitespace().map(|cell| cell.parse::<f64>().ok());
        cells.try_fold(0, |count, number| number.map(|_| count + 1))
    };
    let counts: Vec<Option<usize>> = lines.iter().take(LINES).map(cells).collect();
    let first = counts.first().copied().flatten().unwrap_or_default();
    counts.len() == LINES && first >= LEAST_CELLS && counts.iter().all(|count| *count == Some(first))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_may_stand_below_other_lines_and_text_in_utf_16_is_one() {
        let is = |name: &str, text: &[u8]| is_table(Path::new(name), text);
        assert!(is("a.txt", b"Trace 1\nof 3.5.2026\n\nt;a;b\n0;1,5;2\n1;1,5;2\n2;1,5;2\n3;1,5;2\n"));
        assert!(is("a.txt", b"# t  q1  q2\n0 1.5 2\n1  1.5 2\n2 1.5  -2e-3\n3 1 1\n"));
        assert!(is("a.txt", b"1.5 2\n1.5 2\n1 2\n1.0 -2\n"));
        assert!(is("a.txt", b"\xff\xfet\0;\0"));
        assert!(is("a.txt", b"{\"t\": 0, \"q\": 1}\n{\"t\": 1}\n{\"t\":"));
        assert!(is("a.json", b"[{\"t\": 0, \"q\": 1},{\"t\": 1") && is("a.json", b"[\n {\n  \"t\": 0,\n"));
        assert!(is("a.txt", b" t | q\n---+---\n 0 | 1\n") && is("a.md", b"# Run\n\n| t | q |\n|--:|--:|\n"));
        assert!(is("run.lvm", b"LabVIEW Measurement\n"));
        assert!(is("a.csv", b"t,q\n0,1\n\0\0\0") && !is("a.csv", b"t,q\n\x000,1\n") && !is("a.csv", b"\0\0"));
        let columns = b"{\"t\": [0, 1, 2], \"q\": [1";
        assert!(is_document(Path::new("a.json"), columns) && !is_document(Path::new("a.txt"), columns));
        assert!(!is_document(Path::new("a.json"), b"{\n  \"format\": \"hydrotrace.report.v2\", \"a\": ["));
        for text in [
            &b"{\n  \"a\": [\n    1,\n    2,\n    3\n  ]\n}\n"[..],
            b"a: 1\nb: 2\nc: 3\nd: 4\n",
            b"a, b, c\nd\n",
        ] {
            assert!(!is("a.txt", text), "{}", String::from_utf8_lossy(text));
        }
    }
}
