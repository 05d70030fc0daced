//! Rows of cells, whatever separates them.

use ::csv::{ByteRecord, Reader, ReaderBuilder, Writer, WriterBuilder};

use super::Separator;

/// Walks the rows of a text; blank lines and lines that start with `#` are left out.
pub(super) enum Rows<'a> {
    Bytes { reader: Box<Reader<&'a [u8]>>, text: &'a [u8] },
    Space { rest: &'a [u8], line: u64 },
}

impl<'a> Rows<'a> {
    pub(super) fn new(text: &'a [u8], separator: Separator) -> Self {
        match separator {
            Separator::Byte(byte) => Self::Bytes {
                reader: Box::new(
                    ReaderBuilder::new()
                        .has_headers(false)
                        .flexible(true)
                        .delimiter(byte)
                        .comment(Some(b'#'))
                        // A row at a time needs no more than itself.
                        .buffer_capacity(text.len().clamp(64, 1 << 16))
                        .from_reader(text),
                ),
                text,
            },
            Separator::Space => Self::Space { rest: text, line: 0 },
        }
    }

    /// Reads a row into `record`; the line it starts at, or `None` at the end.
    pub(super) fn next(&mut self, record: &mut ByteRecord) -> Option<u64> {
        match self {
            Self::Bytes { reader, text } => loop {
                // Reading from memory into bytes does not fail.
                if !reader.read_byte_record(record).unwrap_or(false) {
                    return None;
                }
                if record.len() > 1 || record.iter().any(|cell| !cell.trim_ascii().is_empty()) {
                    return Some(record.position().map_or(0, |position| line_of(text, position)));
                }
            },
            Self::Space { rest, line } => loop {
                if rest.is_empty() {
                    return None;
                }
                let end = memchr::memchr(b'\n', rest).map_or(rest.len(), |at| at + 1);
                let (now, later) = rest.split_at(end);
                *rest = later;
                *line += 1;
                let now = now.trim_ascii();
                if now.is_empty() || now.starts_with(b"#") {
                    continue;
                }
                record.clear();
                split_spaces(now, record);
                return Some(*line);
            },
        }
    }
}

/// Writes rows that are read again with the same separator; between cells that blanks separate it puts tabs.
pub(super) fn writer(separator: Separator) -> Writer<Vec<u8>> {
    let byte = match separator {
        Separator::Byte(byte) => byte,
        Separator::Space => b'\t',
    };
    WriterBuilder::new().delimiter(byte).flexible(true).from_writer(Vec::new())
}

/// A text with each row written anew, by its line.
pub(super) fn rewritten(
    text: &[u8],
    separator: Separator,
    mut row: impl FnMut(u64, &ByteRecord, &mut Writer<Vec<u8>>) -> ::csv::Result<()>,
) -> Option<Vec<u8>> {
    let (mut out, mut rows) = (writer(separator), Rows::new(text, separator));
    let mut record = ByteRecord::new();
    while let Some(line) = rows.next(&mut record) {
        row(line, &record, &mut out).ok()?;
    }
    out.into_inner().ok()
}

/// The line of a record, whose position is where the one before ended: blank lines and comments
/// may lie between.
fn line_of(text: &[u8], position: &::csv::Position) -> u64 {
    let mut line = position.line();
    let from = usize::try_from(position.byte()).unwrap_or(usize::MAX);
    let mut rest = text.get(from..).unwrap_or_default();
    while let Some((first, after)) = rest.split_first() {
        match first {
            b'\n' => line += 1,
            b'\r' => {}
            b'#' => {
                let Some(end) = memchr::memchr(b'\n', rest) else { break };
                line += 1;
                rest = &rest[end + 1..];
                continue;
            }
            _ => break,
        }
        rest = after;
    }
    line
}

/// Cells between runs of spaces; quotes hold a cell together.
fn split_spaces(line: &[u8], record: &mut ByteRecord) {
    let mut rest = line;
    while !rest.is_empty() {
        let quoted = rest.strip_prefix(b"\"").and_then(|inner| {
            let end = memchr::memchr(b'"', inner)?;
            Some((&inner[..end], &inner[end + 1..]))
        });
        let (cell, after) = quoted.unwrap_or_else(|| {
            let end = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
            rest.split_at(end)
        });
        record.push_field(cell);
        rest = after.trim_ascii_start();
    }
}

/// The text of a cell: UTF-8, or else the first 256 characters of Unicode, which is what old
/// Windows programs write.
pub(super) fn cell_text(cell: &[u8]) -> String {
    match std::str::from_utf8(cell) {
        Ok(text) => text.trim().to_owned(),
        Err(_) => cell.iter().map(|&byte| char::from(byte)).collect::<String>().trim().to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(text: &str, separator: Separator) -> Vec<(u64, Vec<String>)> {
        let mut rows = Rows::new(text.as_bytes(), separator);
        let mut record = ByteRecord::new();
        let mut found = Vec::new();
        while let Some(line) = rows.next(&mut record) {
            found.push((line, record.iter().map(cell_text).collect()));
        }
        found
    }

    #[test]
    fn rows_know_their_line_and_comments_are_no_rows() {
        let text = "# a comment\na;b\n\n1;2\r\n";
        assert_eq!(
            all(text, Separator::Byte(b';')),
            [(2, vec!["a".into(), "b".into()]), (4, vec!["1".into(), "2".into()])]
        );
        let text = "# a comment\n a  \"b c\"\n\n1\t 2\r\n";
        assert_eq!(
            all(text, Separator::Space),
            [(2, vec!["a".into(), "b c".into()]), (4, vec!["1".into(), "2".into()])]
        );
    }

    #[test]
    fn an_old_degree_sign_is_read() {
        assert_eq!(cell_text(b"J1 [\xb0]"), "J1 [°]");
    }
}
