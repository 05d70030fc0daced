//! JSON lines as a table: the keys of the first object are its columns.

use std::fmt::Write as _;

use serde_json::{Map, Value};

/// Turns objects, a line each, into lines of a table. Lists become columns `KEY_1` and on, objects within objects
/// `KEY_INNER`; keys that the first object lacks are left out.
#[derive(Debug, Clone, Default)]
pub struct JsonLines {
    keys: Vec<String>,
}

impl JsonLines {
    /// Whether a line looks like an object.
    pub fn is_object(line: &[u8]) -> bool {
        line.trim_ascii().starts_with(b"{")
    }

    /// The line as a row, after a header the first time; `None` if it is no object.
    pub fn row(&mut self, line: &[u8]) -> Option<String> {
        let object: Map<String, Value> = serde_json::from_slice(line).ok()?;
        let mut cells = Vec::new();
        for (key, value) in &object {
            flatten(key, value, &mut cells);
        }
        let mut text = String::new();
        if self.keys.is_empty() {
            self.keys = cells.iter().map(|(key, _)| key.clone()).collect();
            push(&mut text, self.keys.iter().map(String::as_str));
        }
        let cell = |key: &String| cells.iter().find(|(other, _)| other == key).map_or("", |(_, cell)| cell);
        push(&mut text, self.keys.iter().map(cell));
        Some(text)
    }
}

fn flatten(key: &str, value: &Value, cells: &mut Vec<(String, String)>) {
    match value {
        Value::Object(inner) => {
            for (name, value) in inner {
                flatten(&format!("{key}_{name}"), value, cells);
            }
        }
        Value::Array(list) => {
            (1..).zip(list).for_each(|(number, value)| flatten(&format!("{key}_{number}"), value, cells));
        }
        Value::String(text) => cells.push((key.to_owned(), text.clone())),
        Value::Null => cells.push((key.to_owned(), String::new())),
        other => cells.push((key.to_owned(), other.to_string())),
    }
}

/// Appends cells as a line, each in quotes.
fn push<'a>(text: &mut String, cells: impl Iterator<Item = &'a str>) {
    let mut before = "";
    for cell in cells {
        // Writing to memory does not fail; a line has no line ends within.
        let _ = write!(text, "{before}\"{}\"", cell.replace('"', "\"\"").replace(['\n', '\r'], " "));
        before = ",";
    }
    text.push('\n');
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn objects_become_rows_of_the_columns_of_the_first() {
        let mut lines = JsonLines::default();
        let first = lines.row(br#"{"t": 0.5, "q": [1, 2.5], "note": "a \"b\"", "in": {"x": null}}"#).unwrap();
        assert_eq!(
            first,
            "\"in_x\",\"note\",\"q_1\",\"q_2\",\"t\"\n\"\",\"a \"\"b\"\"\",\"1\",\"2.5\",\"0.5\"\n"
        );
        assert_eq!(lines.row(br#"{"q": [7], "new": 1, "t": 1}"#).unwrap(), "\"\",\"\",\"7\",\"\",\"1\"\n");
        assert_eq!((lines.row(b"t,1,2"), lines.row(b"{broken")), (None, None));
        assert!(JsonLines::is_object(b" {\"a\":1}") && !JsonLines::is_object(b"a,b"));
    }
}
