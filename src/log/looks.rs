//! What a file looks like by its first bytes.

use std::path::Path;

use super::file::Span;

/// As much of a file as tells what it is if it is no log.
pub(super) const LOOKED_AT: Span = Span { start: 0, end: 4096 };

/// Whether the first bytes of a file are text whose first lines are split alike, or text of a file named as a table.
pub(super) fn is_table(path: &Path, bytes: &[u8]) -> bool {
    const LINES: usize = 3;
    let text = String::from_utf8_lossy(bytes);
    if text.trim().is_empty() || text.chars().any(|c| c.is_control() && !c.is_whitespace()) {
        return false;
    }
    let named = path
        .extension()
        .is_some_and(|ending| ["csv", "tsv"].iter().any(|one| ending.eq_ignore_ascii_case(one)));
    let alike = |separator: char| {
        let lines = text.lines().filter(|line| !line.trim().is_empty() && !line.starts_with('#')).take(LINES);
        let counts: Vec<usize> = lines.map(|line| line.matches(separator).count()).collect();
        counts.len() == LINES && counts[0] > 0 && counts.iter().all(|count| *count == counts[0])
    };
    named || [';', ',', '\t'].into_iter().any(alike)
}
