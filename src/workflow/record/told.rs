//! Whether lines tell what their columns are.

use crate::log::{CsvError, CsvOptions, JsonLines, TableStream};

/// Lines after which the columns are settled.
pub(super) const FIRST_LINES: usize = 10;

/// After so many lines a sender is taken at its word, though nothing is understood: the recording says what is wrong.
const MOST_LINES: usize = 300;

/// Objects that come, with columns for the keys that the caller names.
pub(super) fn objects(options: &CsvOptions) -> JsonLines {
    let named = options.columns.values().flatten().map(|(_, column)| column.clone());
    JsonLines::expecting(named.filter(|column| is_key(column)), options.time.clone())
}

/// Whether a column as a caller names it is a key, and no number of a column or sum of several.
fn is_key(column: &str) -> bool {
    !column.starts_with('#') && column.chars().all(|c| c.is_alphanumeric() || "_. ".contains(c))
}

/// Whether the first lines of a sender tell a recording: their columns are understood, or an option is missing that a user has
/// to give. What else is wrong with the lines of the `sole` sender is said as soon as more of them would not help.
pub(super) fn tells(lines: &[&[u8]], options: &CsvOptions, sole: bool) -> bool {
    if lines.len() < 3 {
        return false;
    }
    let mut objects = objects(options);
    let gathered = lines.iter().filter(|line| JsonLines::has_number(line) && objects.gather(line)).count();
    let first = match gathered {
        0 => lines.iter().flat_map(|line| [line, &b"\n"[..]].concat()).collect(),
        _ => objects.table().into_bytes(),
    };
    match TableStream::begin("what came", &first, options) {
        Ok(_) | Err(CsvError::NoUnit { .. } | CsvError::NotByRows { .. }) => true,
        Err(
            CsvError::NoTable { .. }
            | CsvError::NoTime { .. }
            | CsvError::TimeUnit { .. }
            | CsvError::NoJoints { .. }
            | CsvError::NoPair { .. },
        ) => lines.len() >= MOST_LINES,
        Err(_) => lines.len() >= if sole { FIRST_LINES } else { MOST_LINES },
    }
}
