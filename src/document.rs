//! What every JSON document has in common: the program that wrote it, and its layout.

use serde::Serialize;

/// Name and version of this program, as documents state them.
pub const PROGRAM: &str = concat!("hydrotrace ", env!("CARGO_PKG_VERSION"));

/// Indented JSON with a final line break; numbers that JSON cannot express become null.
pub fn pretty(document: &impl Serialize) -> String {
    let mut text =
        serde_json::to_string_pretty(document).unwrap_or_else(|error| format!("{{\"error\": \"{error}\"}}"));
    text.push('\n');
    text
}
