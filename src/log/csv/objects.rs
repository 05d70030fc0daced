//! JSON lines as a table: the keys of the first objects are its columns.

use std::{collections::BTreeMap, fmt::Write as _};

use serde::de::DeserializeOwned;
use serde_json::{Map, Value};

/// Keys and cells of an object.
type Cells = Vec<(String, String)>;

/// Turns objects, a line each, into lines of a table. Lists become columns `KEY_1` and on, objects within objects
/// `KEY_INNER`. Columns are the keys of all objects that were gathered; keys that come later are counted and left out.
#[derive(Debug, Clone, Default)]
pub struct JsonLines {
    keys: Vec<String>,
    gathered: Vec<Cells>,
    late: BTreeMap<String, u64>,
}

impl JsonLines {
    /// Whether a line looks like an object.
    pub fn is_object(line: &[u8]) -> bool {
        line.trim_ascii().starts_with(b"{")
    }

    /// With columns for keys that are yet to come.
    pub fn expecting(keys: impl IntoIterator<Item = String>) -> Self {
        Self { keys: keys.into_iter().collect(), ..Self::default() }
    }

    /// Takes in one of the first lines; `false` if it is no object.
    pub fn gather(&mut self, line: &[u8]) -> bool {
        let Some(cells) = cells(line) else { return false };
        for (key, _) in &cells {
            if !self.keys.contains(key) {
                self.keys.push(key.clone());
            }
        }
        self.gathered.push(cells);
        true
    }

    /// The lines that were gathered, below a header.
    pub fn table(&self) -> String {
        let mut text = String::new();
        push(&mut text, self.keys.iter().map(String::as_str));
        self.gathered.iter().for_each(|cells| self.push_row(&mut text, cells));
        text
    }

    /// Ends gathering: columns are settled.
    pub fn settle(&mut self) {
        self.gathered.clear();
    }

    /// A line as a row of the columns; `None` if it is no object.
    pub fn row(&mut self, line: &[u8]) -> Option<String> {
        let cells = cells(line)?;
        for (key, _) in cells.iter().filter(|(key, cell)| !cell.is_empty() && !self.keys.contains(key)) {
            *self.late.entry(key.clone()).or_default() += 1;
        }
        let mut text = String::new();
        self.push_row(&mut text, &cells);
        Some(text)
    }

    /// Keys that came after the columns were settled, and the lines with the one that came most.
    pub fn late(&self) -> Option<(String, u64)> {
        let most = self.late.values().max()?;
        Some((self.late.keys().cloned().collect::<Vec<_>>().join(", "), *most))
    }

    fn push_row(&self, text: &mut String, cells: &Cells) {
        let cell =
            |key: &String| cells.iter().find(|(other, _)| other == key).map_or("", |(_, cell)| cell.as_str());
        push(text, self.keys.iter().map(cell));
    }
}

/// A file of objects, a line each or in one list, as the text of a table; `None` if it is none.
pub(super) fn as_table(text: &[u8]) -> Option<Vec<u8>> {
    let mut lines = JsonLines::default();
    match text.trim_ascii_start().first()? {
        b'{' => {
            let all = text.split(|byte| *byte == b'\n').filter(|line| !line.trim_ascii().is_empty());
            let objects = all.clone().filter(|line| lines.gather(line)).count();
            // A line may be cut; a document over several lines is no table.
            (2 * objects > all.count()).then(|| lines.table().into_bytes())
        }
        b'[' => {
            let objects: Vec<Map<String, Value>> = parsed(text)?;
            for object in &objects {
                let line = serde_json::to_vec(object).ok()?;
                lines.gather(&line);
            }
            (!objects.is_empty()).then(|| lines.table().into_bytes())
        }
        _ => None,
    }
}

fn cells(line: &[u8]) -> Option<Cells> {
    let object: Map<String, Value> = parsed(line)?;
    let mut cells = Vec::new();
    for (key, value) in &object {
        flatten(key, value, &mut cells);
    }
    Some(cells)
}

fn parsed<T: DeserializeOwned>(text: &[u8]) -> Option<T> {
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

fn flatten(key: &str, value: &Value, cells: &mut Cells) {
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
    fn objects_become_rows_of_the_columns_of_all_that_were_gathered() {
        let mut lines = JsonLines::expecting(["late".to_owned()]);
        assert!(lines.gather(br#"{"t": 0.5, "q": [1, 2.5], "note": "a \"b\"", "in": {"x": null}}"#));
        assert!(lines.gather(br#"{"t": 1, "act": 7}"#) && !lines.gather(b"{broken"));
        assert_eq!(
            lines.table(),
            "\"late\",\"in_x\",\"note\",\"q_1\",\"q_2\",\"t\",\"act\"\n\
             \"\",\"\",\"a \"\"b\"\"\",\"1\",\"2.5\",\"0.5\",\"\"\n\"\",\"\",\"\",\"\",\"\",\"1\",\"7\"\n"
        );
        lines.settle();
        let row = lines.row(br#"{"q": [7], "new": 1, "empty": null, "late": 3, "t": 1}"#).unwrap();
        assert_eq!(row, "\"3\",\"\",\"\",\"7\",\"\",\"1\",\"\"\n");
        assert_eq!((lines.row(b"t,1,2"), lines.row(b"{broken")), (None, None));
        assert_eq!(lines.late(), Some(("new".to_owned(), 1)));
        assert!(JsonLines::is_object(b" {\"a\":1}") && !JsonLines::is_object(b"a,b"));
    }

    #[test]
    fn a_file_of_objects_is_a_table_and_a_document_is_none() {
        let table = |text: &str| as_table(text.as_bytes()).map(|text| String::from_utf8(text).unwrap());
        let expected = "\"t\",\"q\"\n\"0\",\"\"\n\"1\",\"2\"\n";
        assert_eq!(table("{\"t\":0}\n{\"t\":1,\"q\":2}\n{\"t\":").as_deref(), Some(expected));
        assert_eq!(table("[{\"t\":0},\n {\"t\":1,\"q\":2}]").as_deref(), Some(expected));
        assert_eq!(
            (table("{\n \"t\": 0,\n \"q\": 1\n}"), table("t,q\n0,1\n"), table("[1,2]")),
            (None, None, None)
        );
    }
}
