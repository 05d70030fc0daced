//! JSON lines as a table: the keys of the first objects are its columns.

use std::{
    collections::{BTreeMap, BTreeSet},
    fmt::Write as _,
};

use serde_json::{Map, Value};

use super::{
    label::label,
    lenient::parsed,
    members::{Cells, cells_of, is_naming},
    number::number,
};
use crate::remark::{Code, Remarks};

/// Turns objects, a line each, into lines of a table. Lists become columns `KEY_1` and on, objects within objects
/// `KEY_INNER`. Columns are the keys of all objects that were gathered; keys that come later are counted and left out.
/// Objects that follow each other, agree in what they share and add to each other, as those of the joints at an instant
/// do, are one row. Where objects that come are of a joint each, by its name in one of their keys, columns are `NAME KEY`.
#[derive(Debug, Clone, Default)]
pub struct JsonLines {
    /// Columns that are there whatever comes, and the time if the caller says it.
    expected: Vec<String>,
    time: Option<String>,
    /// Whether lines come one by one; those of a file are seen whole.
    live: bool,
    keys: Vec<String>,
    gathered: Vec<Cells>,
    /// The key that holds the name of a joint, once columns are told.
    naming: Option<String>,
    /// Whether objects add to each other, and the row that the next may add to.
    adds: bool,
    pending: Option<Cells>,
    late: BTreeMap<String, u64>,
}

impl JsonLines {
    /// Whether a line looks like an object.
    pub fn is_object(line: &[u8]) -> bool {
        line.trim_ascii().starts_with(b"{")
    }

    /// Whether a line is an object with a number, maybe as text.
    pub fn has_number(line: &[u8]) -> bool {
        let is_number =
            |cell: &str| [false, true].iter().any(|comma| number(cell.as_bytes(), *comma).is_some());
        cells(line).is_some_and(|cells| cells.iter().any(|(_, cell)| is_number(cell)))
    }

    /// Lines that come one by one, with columns for keys that are yet to come; `time` is the key of the time if the
    /// caller says it.
    pub fn expecting(keys: impl IntoIterator<Item = String>, time: Option<String>) -> Self {
        Self { expected: keys.into_iter().collect(), time, live: true, ..Self::default() }
    }

    /// Takes in one of the first lines; `false` if it is no object.
    pub fn gather(&mut self, line: &[u8]) -> bool {
        let Some(object) = parsed(line) else { return false };
        self.gather_object(object);
        true
    }

    /// The same of an object.
    pub(super) fn gather_object(&mut self, object: Map<String, Value>) {
        self.gathered.push(cells_of(object));
    }

    /// Whether the last line that was gathered is of a joint, or has a key, that none before it was of: others may follow.
    pub fn is_growing(&self) -> bool {
        let Some((last, before)) = self.gathered.split_last().filter(|(_, before)| !before.is_empty()) else {
            return false;
        };
        let is_new = |(key, _): &(String, String)| before.iter().all(|cells| cell(cells, key).is_none());
        let is_named_anew = |key: &str| {
            let name = cell(last, key);
            self.alternates(key) && before.iter().all(|cells| cell(cells, key) != name)
        };
        last.iter().any(is_new) || last.iter().any(|(key, _)| is_naming(key) && is_named_anew(key))
    }

    /// Whether a key says another thing from most objects to the next.
    fn alternates(&self, key: &str) -> bool {
        let names: Vec<&str> = self.gathered.iter().filter_map(|cells| cell(cells, key)).collect();
        let changes = names.windows(2).filter(|two| two[0] != two[1]).count();
        changes > 0 && 2 * changes >= names.len() - 1
    }

    /// The key by which objects are of a joint each: it alternates, and comes back to names that were there.
    fn naming(&self) -> Option<String> {
        let repeats = |key: &str| {
            let names: BTreeSet<&str> = self.gathered.iter().filter_map(|cells| cell(cells, key)).collect();
            names.len() < self.gathered.len()
        };
        let mut keys = self.gathered.iter().flatten().map(|(key, _)| key).filter(|key| is_naming(key));
        keys.find(|key| self.alternates(key) && repeats(key)).cloned()
    }

    /// The lines that were gathered, below a header; of lines that come, without the row that the next may add to.
    pub fn table(&mut self) -> String {
        self.naming = if self.live { self.naming() } else { None };
        let mut rows: Vec<Cells> = Vec::new();
        self.keys.clone_from(&self.expected);
        self.adds = false;
        for cells in &self.gathered {
            let cells = self.of_joint(cells.clone());
            for (key, _) in &cells {
                if !self.keys.contains(key) {
                    self.keys.push(key.clone());
                }
            }
            match rows.last_mut().map(|row| add(row, &cells)) {
                Some(true) => self.adds = true,
                _ => rows.push(cells),
            }
        }
        self.pending = if self.live && self.adds { rows.pop() } else { None };
        let mut text = String::new();
        push(&mut text, self.keys.iter().map(String::as_str));
        for cells in &rows {
            self.push_row(&mut text, cells);
        }
        text
    }

    /// With the name of the joint before each key but the time's.
    fn of_joint(&self, mut cells: Cells) -> Cells {
        let Some(naming) = &self.naming else { return cells };
        let Some(name) = cell(&cells, naming).filter(|name| !name.is_empty()).map(str::to_owned) else {
            return cells;
        };
        let counts = name.bytes().all(|byte| byte.is_ascii_digit());
        let name = if counts { format!("{naming} {name}") } else { name };
        cells.retain(|(key, _)| key != naming);
        for (key, _) in &mut cells {
            let is_time = self.time.as_ref().map_or_else(|| label(key, None).is_time, |time| time == key);
            if !is_time {
                *key = format!("{name} {key}");
            }
        }
        cells
    }

    /// Whether a line has a number with a key that came in none before.
    pub fn has_new_key(&self, line: &[u8]) -> bool {
        let is_new = |(key, cell): &(String, String)| {
            !self.keys.contains(key)
                && !self.late.contains_key(key)
                && number(cell.as_bytes(), false).is_some()
        };
        cells(line).is_some_and(|cells| self.of_joint(cells).iter().any(is_new))
    }

    /// Nothing gathered yet, with columns for all keys so far.
    pub fn anew(&self) -> Self {
        Self::expecting(self.keys.iter().cloned(), self.time.clone())
    }

    /// Ends gathering: columns are settled.
    pub fn settle(&mut self) {
        self.gathered.clear();
    }

    /// A line as a row of the columns, or the row before it where it may yet add to its own; `None` if it is no object.
    pub fn row(&mut self, line: &[u8]) -> Option<String> {
        let cells = self.of_joint(cells(line)?);
        for (key, _) in cells.iter().filter(|(key, cell)| !cell.is_empty() && !self.keys.contains(key)) {
            *self.late.entry(key.clone()).or_default() += 1;
        }
        let mut text = String::new();
        if !self.adds {
            self.push_row(&mut text, &cells);
        } else if !self.pending.as_mut().is_some_and(|row| add(row, &cells)) {
            text = self.rest();
            self.pending = Some(cells);
        }
        Some(text)
    }

    /// The row that is kept for the next line to add to.
    pub fn rest(&mut self) -> String {
        let mut text = String::new();
        if let Some(cells) = self.pending.take() {
            self.push_row(&mut text, &cells);
        }
        text
    }

    /// Keys that came after the columns were settled, and the lines with the one that came most.
    pub fn late(&self) -> Option<(String, u64)> {
        let most = self.late.values().max()?;
        Some((self.late.keys().cloned().collect::<Vec<_>>().join(", "), *most))
    }

    fn push_row(&self, text: &mut String, cells: &Cells) {
        push(text, self.keys.iter().map(|key| cell(cells, key).unwrap_or_default()));
    }
}

fn cell<'a>(cells: &'a Cells, key: &str) -> Option<&'a str> {
    cells.iter().find(|(other, _)| other == key).map(|(_, cell)| cell.as_str())
}

/// Adds cells to a row that has some of them, all alike, and lacks others; else `false`.
fn add(row: &mut Cells, cells: &Cells) -> bool {
    let filled = || cells.iter().filter(|(_, cell)| !cell.is_empty());
    let of_row = |key: &str| cell(row, key).filter(|cell| !cell.is_empty());
    let (mut shared, mut new) = (false, false);
    for (key, cell) in filled() {
        match of_row(key) {
            Some(own) if own != cell => return false,
            Some(_) => shared = true,
            None => new = true,
        }
    }
    if shared && new {
        let more: Cells = filled().filter(|(key, _)| of_row(key).is_none()).cloned().collect();
        row.retain(|(_, cell)| !cell.is_empty());
        row.extend(more);
    }
    shared && new
}

/// A file of objects, a line each or in one list, as the text of a table; `None` if it is none.
pub(super) fn as_table(text: &[u8], remarks: &mut Remarks) -> Option<Vec<u8>> {
    let mut lines = JsonLines::default();
    match text.trim_ascii_start().first()? {
        b'{' => {
            let filled = |line: &(usize, &[u8])| !line.1.trim_ascii().is_empty();
            let all = (1..).zip(text.split(|byte| *byte == b'\n')).filter(filled);
            let broken: Vec<usize> =
                all.clone().filter(|(_, line)| !lines.gather(line)).map(|(number, _)| number).collect();
            // A line may be cut; a document over several lines is no table.
            (2 * broken.len() < all.count()).then(|| {
                if let Some(first) = broken.first() {
                    let message =
                        format!("lines that are no JSON object, the first of them line {first}; left out");
                    remarks.add(Code::UndecodableMessage, broken.len() as u64, message);
                }
                lines.table().into_bytes()
            })
        }
        b'[' => {
            let objects: Vec<Map<String, Value>> = parsed(text)?;
            let some = !objects.is_empty();
            for object in objects {
                lines.gather_object(object);
            }
            some.then(|| lines.table().into_bytes())
        }
        _ => None,
    }
}

fn cells(line: &[u8]) -> Option<Cells> {
    parsed(line).map(cells_of)
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
        let mut lines = JsonLines::expecting(["late".to_owned()], None);
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
    fn a_list_of_names_names_the_lists_beside_it_in_whatever_order() {
        let mut lines = JsonLines::default();
        assert!(
            lines.gather(br#"{"t": 0, "name": ["a", "b"], "set": [1, 2], "in": {"act": [3, 4], "x": [5]}}"#)
        );
        assert!(
            lines.gather(br#"{"t": 1, "name": ["b", "a"], "set": [2, 1], "in": {"act": [4, 3], "x": [5]}}"#)
        );
        let header = "\"a in_act\",\"b in_act\",\"in_x_1\",\"a set\",\"b set\",\"t\"\n";
        let row = |t: u32| format!("\"3\",\"4\",\"5\",\"1\",\"2\",\"{t}\"\n");
        assert_eq!(lines.table(), format!("{header}{}{}", row(0), row(1)));
    }

    #[test]
    fn a_file_of_objects_is_a_table_and_a_document_is_none() {
        let table = |text: &str| {
            as_table(text.as_bytes(), &mut Remarks::default()).map(|text| String::from_utf8(text).unwrap())
        };
        let expected = "\"t\",\"q\"\n\"0\",\"\"\n\"1\",\"2\"\n";
        assert_eq!(table("{\"t\":0}\n{\"t\":1,\"q\":2}\n{\"t\":").as_deref(), Some(expected));
        assert_eq!(table("[{\"t\":0},\n {\"t\":1,\"q\":2}]").as_deref(), Some(expected));
        assert_eq!(
            (table("{\n \"t\": 0,\n \"q\": 1\n}"), table("t,q\n0,1\n"), table("[1,2]")),
            (None, None, None)
        );
    }
}
