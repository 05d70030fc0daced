//! Names come from logs, and may hold anything.

/// Without control characters, which would reach the reader's terminal.
pub(in crate::render) fn clean(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { char::REPLACEMENT_CHARACTER } else { c }).collect()
}
