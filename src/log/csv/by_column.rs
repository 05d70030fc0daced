//! JSON documents that hold a table: a list for each column, rows beside the names of their columns, rows within an object, or rows alone.

use serde_json::{Map, Value};

use super::{
    lenient::parsed,
    members::{LISTS, listed},
    objects::JsonLines,
    trajectory,
};

/// Rows of a table at least.
const LEAST: usize = 3;

/// Columns of a matrix at most.
const WIDEST: usize = 1000;

/// The text of the table that a document holds; `None` if it holds none.
pub(super) fn as_table(text: &[u8]) -> Option<Vec<u8>> {
    match text.trim_ascii_start().first()? {
        b'{' => {}
        b'[' => return bare(text),
        _ => return None,
    }
    let lines = text.trim_ascii().splitn(2, |byte| *byte == b'\n').collect::<Vec<_>>();
    // An object a line is another form.
    if lines.len() > 1 && parsed::<Map<String, Value>>(lines[0]).is_some() {
        return None;
    }
    let document: Map<String, Value> = parsed(text)?;
    if let Some(planned) = trajectory::of(&document) {
        return trajectory::table(vec![planned]);
    }
    let joints = joints(&document);
    let rows = split(&document).or_else(|| by_columns(&document)).or_else(|| within(document))?;
    let mut lines = JsonLines::default();
    for mut row in rows {
        let names_its_own = row.keys().any(|key| LISTS.contains(&key.to_lowercase().as_str()));
        if let Some(joints) = joints.as_ref().filter(|_| !names_its_own) {
            row.insert(LISTS[0].to_owned(), joints.clone());
        }
        lines.gather_object(row);
    }
    Some(lines.table().into_bytes())
}

/// Rows of numbers, whose columns have no names.
fn bare(text: &[u8]) -> Option<Vec<u8>> {
    let rows: Vec<Vec<Option<serde_json::Number>>> = serde_json::from_slice(text).ok()?;
    let wide = rows.first()?.len();
    if rows.len() < LEAST || wide < 2 || rows.iter().any(|row| row.len() != wide) {
        return None;
    }
    let cell =
        |value: Option<serde_json::Number>| value.map_or_else(String::new, |number| number.to_string());
    let line =
        |row: Vec<Option<serde_json::Number>>| row.into_iter().map(cell).collect::<Vec<_>>().join(",") + "\n";
    Some(rows.into_iter().map(line).collect::<String>().into_bytes())
}

/// The names of joints that a document lists beside its table, for the lists in it.
fn joints(document: &Map<String, Value>) -> Option<Value> {
    let within = |value: &Value| value.as_object().and_then(joints);
    let own = || listed(document).map(|names| names.into_iter().map(Value::from).collect());
    own().or_else(|| document.values().find_map(within))
}

type Rows = Vec<Map<String, Value>>;

/// Names of columns and a list of rows in their order.
fn split(document: &Map<String, Value>) -> Option<Rows> {
    let names: Vec<String> = document
        .get("columns")?
        .as_array()?
        .iter()
        .map(|name| name.as_str().map(str::to_owned))
        .collect::<Option<_>>()?;
    let row = |row: &Value| {
        let cells = row.as_array().filter(|cells| cells.len() == names.len())?;
        Some(names.iter().cloned().zip(cells.iter().cloned()).collect())
    };
    let rows: Rows = document.get("data")?.as_array()?.iter().map(row).collect::<Option<_>>()?;
    (rows.len() >= LEAST).then_some(rows)
}

/// Lists of one length, the longest of which there are two, wherever in the document: shorter ones are of joints, and no columns.
fn by_columns(document: &Map<String, Value>) -> Option<Rows> {
    let mut columns: Vec<(Vec<&str>, Vec<&Value>)> = Vec::new();
    gather(document, &mut Vec::new(), &mut columns);
    let count = |length: usize| columns.iter().filter(|(_, values)| values.len() == length).count();
    let length = columns.iter().map(|(_, values)| values.len()).filter(|length| count(*length) > 1).max()?;
    columns.retain(|(_, values)| values.len() == length);
    if length < LEAST {
        return None;
    }
    // What all are in says nothing of one.
    let shared = |depth: usize| {
        let first = columns[0].0.get(depth).filter(|_| columns[0].0.len() > depth + 1);
        first.is_some_and(|first| {
            columns.iter().all(|(path, _)| path.len() > depth + 1 && path[depth] == *first)
        })
    };
    let from = (0..columns[0].0.len()).take_while(|depth| shared(*depth)).count();
    let names: Vec<String> = columns.iter().map(|(path, _)| path[from..].join("_")).collect();
    let row =
        |at: usize| names.iter().cloned().zip(columns.iter().map(|(_, values)| values[at].clone())).collect();
    Some((0..length).map(row).collect())
}

/// The lists of an object and of those within it; an object of numbered keys is a list, too.
fn gather<'a>(
    object: &'a Map<String, Value>,
    path: &mut Vec<&'a str>,
    columns: &mut Vec<(Vec<&'a str>, Vec<&'a Value>)>,
) {
    let cell = |value: &Value| match value {
        Value::Array(inner) => {
            inner.len() <= WIDEST && inner.iter().all(|value| value.is_number() || value.is_null())
        }
        Value::Object(_) => false,
        _ => true,
    };
    for (key, value) in object {
        path.push(key);
        let numbered = |inner: &Map<String, Value>| {
            inner.len() >= LEAST && (0..inner.len()).all(|at| inner.contains_key(&at.to_string()))
        };
        match value {
            Value::Array(list) if list.iter().all(cell) => {
                columns.push((path.clone(), list.iter().collect()));
            }
            Value::Object(inner) if numbered(inner) => {
                columns.push((path.clone(), (0..inner.len()).map(|at| &inner[&at.to_string()]).collect()));
            }
            Value::Object(inner) => gather(inner, path, columns),
            // One run of several that there might be.
            Value::Array(list) => {
                if let [Value::Object(inner)] = &list[..] {
                    gather(inner, path, columns);
                }
            }
            _ => {}
        }
        path.pop();
    }
}

/// The longest list of objects of a document.
fn within(document: Map<String, Value>) -> Option<Rows> {
    let mut longest: Option<Rows> = None;
    for (_, value) in document {
        let found = match value {
            Value::Array(list) if list.len() >= LEAST && list.iter().all(Value::is_object) => {
                let object = |value| if let Value::Object(object) = value { Some(object) } else { None };
                Some(list.into_iter().filter_map(object).collect())
            }
            Value::Object(inner) => within(inner),
            _ => None,
        };
        if found.as_ref().map_or(0, Vec::len) > longest.as_ref().map_or(0, Vec::len) {
            longest = found;
        }
    }
    longest
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> Option<String> {
        as_table(text.as_bytes()).map(|text| String::from_utf8(text).unwrap())
    }

    #[test]
    fn documents_of_columns_of_rows_and_of_rows_within_are_tables() {
        let expected =
            "\"q_act\",\"q_set\",\"t\"\n\"4\",\"1\",\"0\"\n\"5\",\"2\",\"0.5\"\n\"6\",\"\",\"1\"\n";
        for text in [
            r#"{"t": [0, 0.5, 1], "q_set": [1, 2, NaN], "q_act": [4, 5, 6], "gains": [1, 2]}"#,
            r#"{"run": {"t": [0, 0.5, 1], "q": {"set": [1, 2, null], "act": [4, 5, 6]}}, "by": "x"}"#,
            r#"{"data": [{"t": [0, 0.5, 1], "q_set": [1, 2, null], "q_act": [4, 5, 6]}], "by": "x"}"#,
            r#"{"columns": ["q_act", "q_set", "t"], "index": [0, 1, 2], "data": [[4, 1, 0], [5, 2, 0.5], [6, null, 1]]}"#,
            r#"{"t": {"0": 0, "1": 0.5, "2": 1}, "q_set": {"0": 1, "1": 2, "2": null}, "q_act": {"0": 4, "1": 5, "2": 6}}"#,
            r#"{"v": 2, "samples": [{"t": 0, "q_set": 1, "q_act": 4}, {"t": 0.5, "q_set": 2, "q_act": 5}, {"t": 1, "q_set": null, "q_act": 6}]}"#,
        ] {
            assert_eq!(of(text).as_deref(), Some(expected), "{text}");
        }
        let joints = r#""joints": ["a", "b", "c"], "kp": [1, 2, 3], "kd": [1, 2, 3]"#;
        let beside = of(&format!(r#"{{"t": [0, 1, 2, 3], "q": [1, 2, 3, 4], {joints}}}"#)).unwrap();
        assert!(beside.starts_with("\"q\",\"t\"\n\"1\",\"0\"\n"), "{beside}");
        let matrix = of(r#"{"t": [0, 1, 2], "q": [[1, 2], [3, 4], [5, 6]]}"#).unwrap();
        assert!(matrix.starts_with("\"q_1\",\"q_2\",\"t\"\n\"1\",\"2\",\"0\"\n"), "{matrix}");
        for named in [
            r#"{"joint_names": ["boom", "arm"], "t": [0, 1, 2], "q": [[1, 2], [3, 4], [5, 6]]}"#,
            r#"{"meta": {"joints": ["boom", "arm"]}, "rows": [{"t": 0, "q": [1, 2]}, {"t": 1, "q": [3, 4]}, {"t": 2, "q": [5, 6]}]}"#,
        ] {
            let named = of(named).unwrap();
            assert!(named.starts_with("\"boom q\",\"arm q\",\"t\"\n\"1\",\"2\",\"0\"\n"), "{named}");
        }
        assert_eq!(of("[[0, 1.5], [1, null],\n [2, 3]]").as_deref(), Some("0,1.5\n1,\n2,3\n"));
        for other in [
            r#"{"t": 0, "q": [1, 2, 3]}"#, r#"{"a": [1, 2], "b": [1, 2]}"#, "{}", "[1]", "[[1, 2], [3]]",
            "t,q",
        ] {
            assert_eq!(of(other), None, "{other}");
        }
    }
}
