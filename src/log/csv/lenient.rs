//! JSON as Python writes it.

use serde::de::DeserializeOwned;

/// What a text holds; `None` if it is no JSON, but for numbers that are none.
pub(super) fn parsed<T: DeserializeOwned>(text: &[u8]) -> Option<T> {
    serde_json::from_slice(text).or_else(|_| serde_json::from_slice(&without_nan(text))).ok()
}

/// A text with `null` for the numbers that are none, which Python writes and JSON does not know.
fn without_nan(text: &[u8]) -> Vec<u8> {
    const NONE: [&[u8]; 3] = [b"NaN", b"-Infinity", b"Infinity"];
    let mut kept = Vec::with_capacity(text.len());
    let (mut quoted, mut at) = (false, 0);
    while let Some(&byte) = text.get(at) {
        let word = NONE.into_iter().find(|word| !quoted && text[at..].starts_with(word));
        if let Some(word) = word {
            kept.extend_from_slice(b"null");
            at += word.len();
            continue;
        }
        if byte == b'\\' && quoted {
            kept.push(byte);
            at += 1;
        } else if byte == b'"' {
            quoted = !quoted;
        }
        kept.extend(text.get(at));
        at += 1;
    }
    kept
}
