//! Messages as `ros2 topic echo` and `rostopic echo` print them: YAML documents with `---` between them.

use serde_json::{Map, Value};
use yaml_rust2::{
    parser::{Event, Parser},
    scanner::TScalarStyle,
};

use super::{objects::JsonLines, trajectory};

const BETWEEN: &str = "---";

/// What is nested deeper is no message.
const DEEPEST: usize = 32;

/// A text without what is told above a message of others that were lost.
fn without_notes(mut text: &str) -> &str {
    const LOST: [&str; 2] = ["A message was lost", "\ttotal count"];
    while LOST.iter().any(|note| text.starts_with(note)) {
        text = text.split_once('\n').map_or("", |(_, rest)| rest);
    }
    text
}

/// Whether a text begins with a message: with its header, or with keys and a line `---` somewhere behind them.
pub(in crate::log) fn begins(text: &str) -> bool {
    let mut lines = without_notes(text)
        .lines()
        .map(str::trim_end)
        .filter(|line| !line.is_empty() && !line.starts_with('#'));
    let key = lines.find(|line| *line != BETWEEN).and_then(|line| line.split_once(':'));
    let Some((key, "" | " ")) = key.map(|(key, rest)| (key, rest.get(..1).unwrap_or_default())) else {
        return false;
    };
    let is_field = !key.is_empty() && key.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'_');
    is_field && (key == "header" || lines.any(|line| line == BETWEEN))
}

/// A file of messages as the text of a table, a row each; `None` if most of its documents are none.
pub(super) fn as_table(text: &[u8]) -> Option<Vec<u8>> {
    let text = std::str::from_utf8(text).ok().filter(|text| begins(text))?;
    let (mut lines, mut plans) = (JsonLines::default(), Vec::new());
    let (mut all, mut messages) = (0_usize, 0_usize);
    let mut take = |document: &str| {
        let document = without_notes(document);
        if !document.trim().is_empty() {
            all += 1;
            // The last one may be cut.
            if let Some(message) = message(document) {
                messages += 1;
                match trajectory::of(&message) {
                    Some(plan) => plans.push(plan),
                    None => lines.gather_object(message),
                }
            }
        }
    };
    let (mut from, mut at) = (0, 0);
    for line in text.split_inclusive('\n') {
        if line.trim_end() == BETWEEN {
            take(&text[from..at]);
            from = at + line.len();
        }
        at += line.len();
    }
    take(&text[from..]);
    if 2 * messages <= all {
        return None;
    }
    if plans.len() == messages { trajectory::table(plans) } else { Some(lines.table().into_bytes()) }
}

/// A list or mapping whose end is yet to come, and the key of the value that comes next.
struct Open {
    value: Value,
    key: Option<String>,
}

/// The keys of a document. Walked as events: aliases, which ask for any amount of memory, are refused.
fn message(document: &str) -> Option<Map<String, Value>> {
    let mut parser = Parser::new_from_str(document);
    let mut open: Vec<Open> = Vec::new();
    loop {
        let value = match parser.next_token().ok()?.0 {
            Event::StreamStart | Event::DocumentStart => continue,
            Event::MappingStart(..) | Event::SequenceStart(..) if open.len() >= DEEPEST => return None,
            Event::MappingStart(..) => {
                open.push(Open { value: Value::Object(Map::new()), key: None });
                continue;
            }
            Event::SequenceStart(..) => {
                open.push(Open { value: Value::Array(Vec::new()), key: None });
                continue;
            }
            Event::Scalar(text, style, ..) => match open.last_mut() {
                Some(Open { value: Value::Object(_), key: key @ None }) => {
                    *key = Some(text);
                    continue;
                }
                _ => scalar(text, style),
            },
            Event::MappingEnd | Event::SequenceEnd => open.pop()?.value,
            _ => return None,
        };
        match open.last_mut() {
            Some(Open { value: Value::Array(list), .. }) => list.push(value),
            Some(Open { value: Value::Object(object), key }) => {
                object.insert(key.take()?, value);
            }
            _ => return if let Value::Object(object) = value { Some(object) } else { None },
        }
    }
}

/// A scalar as JSON has it; numbers that are none are `null` there.
fn scalar(text: String, style: TScalarStyle) -> Value {
    if style != TScalarStyle::Plain {
        return Value::String(text);
    }
    match text.to_ascii_lowercase().as_str() {
        "" | "~" | "null" | ".nan" | "nan" | ".inf" | "-.inf" | "inf" | "-inf" => Value::Null,
        "true" => Value::Bool(true),
        "false" => Value::Bool(false),
        plain => plain
            .parse::<i64>()
            .map(Value::from)
            .or_else(|_| plain.parse::<f64>().map(Value::from))
            .unwrap_or(Value::String(text)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(text: &str) -> Option<String> {
        as_table(text.as_bytes()).map(|text| String::from_utf8(text).unwrap())
    }

    #[test]
    fn messages_in_either_style_of_yaml_are_rows() {
        let expected = "\"header_stamp_nsec\",\"header_stamp_sec\",\"a position\",\"b position\"\n\
                        \"5\",\"1\",\"0.5\",\"-2e-7\"\n\"6\",\"1\",\"\",\"3\"\n";
        let block = "header:\n  stamp:\n    sec: 1\n    nsec: 5\nname:\n- a\n- b\nposition:\n- 0.5\n- -2.0e-07\n\
                     velocity: []\n---\nheader:\n  stamp:\n    sec: 1\n    nsec: 6\nname: ['a', b]\n\
                     position: [.nan, 3]\n---\nheader:\n  sta: {";
        assert_eq!(table(block).unwrap(), expected);
        let noted = block.replacen(
            "---\n",
            "---\nA message was lost!!!\n\ttotal count change:1\n\ttotal count: 1---\n",
            1,
        );
        assert_eq!(table(&noted).unwrap(), expected);
    }

    #[test]
    fn other_texts_begin_with_no_message() {
        for text in
            ["a: 1\nb: 2\n", "t;q\n---\n0;1\n", "10:30\n---\n", "", "---\n---\n", "Run 7: fast\n---\n"]
        {
            assert!(!begins(text), "{text}");
        }
        assert!(begins("---\nheader:\n") && begins("data: 1.5\n---\ndata: 2\n"));
        assert_eq!(table("note: 1\n---\n0;1\n1;2\n"), None);
    }

    #[test]
    fn aliases_and_deep_nesting_are_no_message() {
        assert_eq!(message("a: &x [1]\nb: *x\n"), None);
        assert_eq!(message(&format!("a: {}", "[".repeat(1000))), None);
        assert_eq!(message("? {a: 1}\n: 2\n"), None);
    }
}
