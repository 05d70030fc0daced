//! Names come from logs, and may hold anything.

/// Without characters that would steer the reader's terminal or turn text round.
pub(in crate::render) fn clean(text: &str) -> String {
    text.chars().map(crate::text::harmless).collect()
}
