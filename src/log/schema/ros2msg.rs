//! The `.msg` notation, concatenated as MCAP stores it: the root first, then each dependency
//! after a line of `=` and a line `MSG: package/Type`.

use super::{Number, SchemaError, Shape, Struct, plain_name};

/// The one byte that the wire of ROS 2 has where a message has no field.
pub(super) const NO_FIELD: &str = "structure_needs_at_least_one_member";

pub(super) fn parse(root: &str, text: &str) -> Result<Vec<Struct<String>>, SchemaError> {
    let mut structs = vec![Struct { name: plain_name(root), fields: Vec::new() }];
    let mut after_rule = false;
    for (index, raw) in text.lines().enumerate() {
        let line = raw.trim();
        if line.len() >= 3 && line.bytes().all(|byte| byte == b'=') {
            after_rule = true;
            continue;
        }
        if line == "---" {
            // The answer of a service, or the result of an action, is a message of its own.
            structs
                .push(Struct { name: format!("{}_{}", plain_name(root), structs.len()), fields: Vec::new() });
            continue;
        }
        if after_rule && !line.is_empty() {
            after_rule = false;
            if let Some(name) = line.strip_prefix("MSG:") {
                let name = plain_name(name.trim());
                // Some writers give the root its own header; it is the same struct then.
                let root_again =
                    matches!(&structs[..], [root] if root.name == name && root.fields.is_empty());
                if !root_again {
                    structs.push(Struct { name, fields: Vec::new() });
                }
                continue;
            }
        }
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let error = || SchemaError::Line { line: index + 1, text: line.to_owned() };
        if let Some(field) = field(line).ok_or_else(error)?
            && let Some(last) = structs.last_mut()
        {
            last.fields.push(field);
        }
    }
    for one in &mut structs {
        if one.fields.is_empty() {
            one.fields.push((NO_FIELD.into(), Shape::Number(Number::U8)));
        }
    }
    Ok(structs)
}

type Field = (String, Shape<String>);

/// One line: a field, `Some(None)` for a constant, `None` for neither.
#[expect(clippy::option_option, reason = "field, constant, or error")]
fn field(line: &str) -> Option<Option<Field>> {
    let (kind, rest) = line.split_once(char::is_whitespace)?;
    let rest = rest.trim_start();
    let end = rest.find(|c: char| !(c.is_ascii_alphanumeric() || c == '_')).unwrap_or(rest.len());
    let (name, after) = rest.split_at(end);
    if name.is_empty() {
        return None;
    }
    let after = after.trim_start();
    if after.starts_with('=') {
        return Some(None);
    }
    // What follows the name is a default value or a comment; neither is on the wire.
    Some(Some((name.to_owned(), shape(kind)?)))
}

/// `float64`, `string<=10`, `Point[]`, `uint8[16]`, `string<=8[<=4]`.
fn shape(kind: &str) -> Option<Shape<String>> {
    let (element, array) = match kind.find('[') {
        Some(at) => (&kind[..at], Some(kind[at + 1..].strip_suffix(']')?)),
        None => (kind, None),
    };
    let bare = element.split("<=").next()?;
    let of = match bare {
        "string" => Shape::Text,
        "wstring" => Shape::WideText,
        "" => return None,
        _ => number(bare).map_or_else(
            || Shape::Struct(if bare.contains('/') { plain_name(bare) } else { bare.to_owned() }),
            Shape::Number,
        ),
    };
    Some(match array {
        None => of,
        Some(bound) if bound.is_empty() || bound.starts_with("<=") => Shape::Sequence(Box::new(of)),
        Some(count) => Shape::Array(count.parse().ok()?, Box::new(of)),
    })
}

fn number(name: &str) -> Option<Number> {
    Some(match name {
        "bool" => Number::Bool,
        "int8" => Number::I8,
        "uint8" | "byte" | "char" => Number::U8,
        "int16" => Number::I16,
        "uint16" => Number::U16,
        "int32" => Number::I32,
        "uint32" => Number::U32,
        "int64" => Number::I64,
        "uint64" => Number::U64,
        "float32" => Number::F32,
        "float64" => Number::F64,
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn constants_defaults_comments_bounds_and_crlf_are_understood() {
        let text = "# head\r\nuint8 MODE_A=1 # one\r\nstring NAME = \"x\"\r\nint32 count 5\r\n\
                    string<=10[<=4] names\r\nfloat64[3] axis  # three\r\nPoint[] points\r\n\
                    string label \"a=b\"\r\n";
        let structs = parse("pkg/msg/Thing", text).unwrap();
        assert_eq!(structs[0].name, "pkg/Thing");
        let names: Vec<&str> = structs[0].fields.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["count", "names", "axis", "points", "label"]);
        assert_eq!(structs[0].fields[1].1, Shape::Sequence(Box::new(Shape::Text)));
        assert_eq!(structs[0].fields[2].1, Shape::Array(3, Box::new(Shape::Number(Number::F64))));
        assert_eq!(structs[0].fields[3].1, Shape::Sequence(Box::new(Shape::Struct("Point".into()))));
    }

    #[test]
    fn a_line_that_is_no_field_is_located() {
        let err = parse("a/b", "float64 x\nfloat64[ y\n").unwrap_err();
        assert_eq!(err, SchemaError::Line { line: 2, text: "float64[ y".into() });
    }

    #[test]
    fn dependencies_follow_a_rule_and_their_name() {
        let rule = "=".repeat(80);
        let text = format!("Inner inner\n{rule}\nMSG: pkg/Inner\nfloat64 x\n{rule}\nMSG: other/msg/Empty\n");
        let structs = parse("pkg/Outer", &text).unwrap();
        assert_eq!(
            structs.iter().map(|s| s.name.as_str()).collect::<Vec<_>>(),
            ["pkg/Outer", "pkg/Inner", "other/Empty"]
        );
        assert_eq!(structs[2].fields.len(), 1);
    }
}
