//! JSON as text.

use serde::Serialize;

pub(super) use super::kit::PROGRAM;

/// Indented JSON with a final line break; numbers that JSON cannot express become null.
pub(super) fn pretty(document: &impl Serialize) -> String {
    let mut text =
        serde_json::to_string_pretty(document).unwrap_or_else(|error| format!("{{\"error\": \"{error}\"}}"));
    text.push('\n');
    text
}
