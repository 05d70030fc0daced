//! The values within an object of JSON as cells, by the path of their keys; names of joints stand before those that are theirs.

use std::collections::BTreeSet;

use serde_json::{Map, Value};

use super::keys::NAMES;

/// Keys of lists of the names of joints.
pub(super) const LISTS: [&str; 5] = ["name", "names", "joint_names", "joints", "joint"];

/// Keys and cells of an object.
pub(super) type Cells = Vec<(String, String)>;

/// Whether a key says of what an object is.
pub(super) fn is_naming(key: &str) -> bool {
    NAMES.contains(&key.trim_matches(['_', ' ']).to_lowercase().as_str())
}

/// The cells of an object.
pub(super) fn cells_of(object: Map<String, Value>) -> Cells {
    let mut cells = Vec::new();
    flatten_object("", &published(object), None, &mut cells);
    cells
}

/// A message that a bridge published, with its topic; other objects as they are.
fn published(mut object: Map<String, Value>) -> Map<String, Value> {
    let is_published = object.get("op").is_some_and(|op| op == "publish") && object.contains_key("topic");
    match object.remove("msg") {
        Some(Value::Object(mut message)) if is_published && !message.contains_key("topic") => {
            message.extend(object.remove("topic").map(|topic| ("topic".to_owned(), topic)));
            message
        }
        other => {
            object.extend(other.map(|value| ("msg".to_owned(), value)));
            object
        }
    }
}

/// The names of joints that an object lists, for the lists beside them and in objects within.
pub(super) fn listed(object: &Map<String, Value>) -> Option<Vec<&str>> {
    let lists = object.iter().filter(|(key, _)| LISTS.contains(&key.to_lowercase().as_str()));
    let mut found = lists
        .filter_map(|(_, value)| value.as_array()?.iter().map(Value::as_str).collect::<Option<Vec<&str>>>());
    found.find(|names| !names.is_empty() && names.iter().collect::<BTreeSet<_>>().len() == names.len())
}

/// The objects of a list by the name that each has in one key, no two the same.
fn named(list: &[Value]) -> Option<Vec<(&str, &Map<String, Value>)>> {
    let first = list.first()?.as_object()?;
    let key = first.iter().find(|(key, value)| is_naming(key) && value.is_string())?.0;
    let of = |value| of_key(value, key);
    let objects: Vec<_> = list.iter().map(of).collect::<Option<_>>()?;
    let distinct: BTreeSet<&str> = objects.iter().map(|(name, _)| *name).collect();
    (distinct.len() == objects.len() && !distinct.contains("")).then_some(objects)
}

fn of_key<'a>(value: &'a Value, key: &str) -> Option<(&'a str, &'a Map<String, Value>)> {
    let object = value.as_object()?;
    Some((object.get(key)?.as_str()?, object))
}

/// Adds the cells of the values of an object; `before` stands before its keys, `names` are those of the object it is in.
fn flatten_object(before: &str, object: &Map<String, Value>, names: Option<&[&str]>, cells: &mut Cells) {
    let own = listed(object);
    let names = own.as_deref().or(names);
    for (key, value) in object {
        let path = if before.is_empty() { key.clone() } else { format!("{before}_{key}") };
        let of_joints = value.as_array().zip(names).filter(|(list, names)| {
            list.len() == names.len() && list.iter().all(|value| value.is_number() || value.is_null())
        });
        match of_joints {
            Some((list, names)) => {
                names
                    .iter()
                    .zip(list)
                    .for_each(|(name, value)| flatten(&format!("{name} {path}"), value, None, cells));
            }
            // Names are no values.
            None if own.is_some() && LISTS.contains(&key.to_lowercase().as_str()) => {}
            None => flatten(&path, value, names, cells),
        }
    }
}

fn flatten(key: &str, value: &Value, names: Option<&[&str]>, cells: &mut Cells) {
    match value {
        Value::Array(list) if named(list).is_some() => {
            // A list that is called so says no more than its names.
            let shown = match key.rsplit_once('_') {
                Some((path, last)) if is_naming(last) => path,
                _ => {
                    if is_naming(key) {
                        ""
                    } else {
                        key
                    }
                }
            };
            for (name, object) in named(list).into_iter().flatten() {
                let mut own = Cells::new();
                flatten_object(shown, object, None, &mut own);
                cells.extend(own.into_iter().map(|(key, cell)| (format!("{name} {key}"), cell)));
            }
        }
        Value::Object(inner) => flatten_object(key, inner, names, cells),
        Value::Array(list) => {
            (1..)
                .zip(list)
                .for_each(|(number, value)| flatten(&format!("{key}_{number}"), value, names, cells));
        }
        Value::String(text) => cells.push((key.to_owned(), text.clone())),
        Value::Null => cells.push((key.to_owned(), String::new())),
        other => cells.push((key.to_owned(), other.to_string())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn objects_in_a_list_are_of_the_joint_that_each_names() {
        let of = |text: &str| cells_of(serde_json::from_str(text).unwrap());
        let cell = |key: &str, cell: &str| (key.to_owned(), cell.to_owned());
        for list in [
            r#"[{"name": "boom", "set": 1}, {"name": "arm", "set": 2}]"#,
            r#"[{"set": 2, "name": "arm"}, {"set": 1, "name": "boom"}]"#,
        ] {
            let mut cells = of(&format!(r#"{{"joints": {list}, "motors": {list}}}"#));
            cells.sort();
            cells.retain(|(key, _)| !key.contains("name"));
            let expected = ["arm motors_set", "arm set", "boom motors_set", "boom set"];
            assert_eq!(cells, expected.map(|key| cell(key, if key.starts_with('a') { "2" } else { "1" })));
        }
        let within = of(r#"{"planned": {"joints": [{"name": "boom", "set": 1}]}}"#);
        assert!(within.contains(&cell("boom planned_set", "1")), "{within:?}");
        let twice = of(r#"{"q": [{"name": "a", "set": 1}, {"name": "a", "set": 2}]}"#);
        assert!(twice.contains(&cell("q_1_set", "1")), "{twice:?}");
    }
}
