//! Message definitions, parsed from the text that a file carries.

mod builtin;
mod ros2idl;
mod ros2msg;

use std::collections::BTreeMap;

use thiserror::Error;

pub(super) use builtin::builtin;

/// A numeric type of the wire.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Number {
    Bool,
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

impl Number {
    /// Size and natural alignment, bytes.
    pub(super) fn size(self) -> u8 {
        match self {
            Self::Bool | Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }
}

/// The shape of a field; `R` is how it refers to other structs (a name, or an index).
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Shape<R> {
    Number(Number),
    Text,
    WideText,
    Struct(R),
    Array(u32, Box<Shape<R>>),
    Sequence(Box<Shape<R>>),
}

/// A struct of the definition.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Struct<R> {
    /// `package/Type`.
    pub(super) name: String,
    pub(super) fields: Vec<(String, Shape<R>)>,
}

/// A message type with everything it refers to; the root is the first struct.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Definition {
    pub(super) structs: Vec<Struct<usize>>,
    /// Whether messages may go on after the last field known here.
    pub(super) open_ended: bool,
    /// Whether messages are laid out as ROS 1 does: no header before, no padding within.
    pub(super) packed: bool,
}

/// Why a schema text yields no definition.
#[derive(Debug, Clone, Error, PartialEq, Eq)]
#[non_exhaustive]
pub(super) enum SchemaError {
    #[error("schema encoding {encoding:?} of {name:?} is not one of ros2msg, ros2idl, ros1msg")]
    Encoding { encoding: String, name: String },
    #[error("schema line {line} is no field: {text:?}")]
    Line {
        /// Line in the schema text, from 1.
        line: usize,
        text: String,
    },
    #[error("schema has {found:?} where {expected} was expected")]
    Unexpected { found: String, expected: &'static str },
    #[error("type {name:?} is used in {within:?} but not defined")]
    Undefined { name: String, within: String },
    #[error("schema {name:?} of {bytes} bytes is longer than {MAX_TEXT} bytes")]
    TooLong { name: String, bytes: usize },
    #[error("schema {name:?} has no text")]
    Empty { name: String },
}

/// Longest schema text, bytes; the longest of ROS 2 have some ten thousand.
const MAX_TEXT: usize = 1 << 20;

impl Definition {
    /// Parses the text of a schema record.
    ///
    /// # Errors
    ///
    /// [`SchemaError`] with the line or word that is not understood.
    pub(super) fn parse(name: &str, encoding: &str, text: &[u8]) -> Result<Self, SchemaError> {
        if text.len() > MAX_TEXT {
            return Err(SchemaError::TooLong { name: name.to_owned(), bytes: text.len() });
        }
        let text = String::from_utf8_lossy(text);
        if text.trim().is_empty() {
            return builtin(name).ok_or_else(|| SchemaError::Empty { name: name.to_owned() });
        }
        let structs = match encoding {
            "ros2msg" => ros2msg::parse(name, &text)?,
            "ros1msg" => ros1(ros2msg::parse(name, &text)?),
            "ros2idl" => ros2idl::parse(&text)?,
            _ => return Err(SchemaError::Encoding { encoding: encoding.to_owned(), name: name.to_owned() }),
        };
        let definition = resolve(&plain_name(name), structs)?;
        Ok(Self { packed: encoding == "ros1msg", ..definition })
    }
}

/// Structs as ROS 1 writes them: one without a field takes no byte.
fn ros1(mut structs: Vec<Struct<String>>) -> Vec<Struct<String>> {
    for one in &mut structs {
        one.fields.retain(|(name, _)| name != ros2msg::NO_FIELD);
    }
    structs
}

/// `package/Type` from `package/msg/Type`, `package::msg::Type` and the like.
pub(super) fn plain_name(name: &str) -> String {
    let parts: Vec<&str> = name.split(['/', ':']).filter(|part| !part.is_empty()).collect();
    match parts[..] {
        [package, .., last] => format!("{package}/{last}"),
        [only] => only.to_owned(),
        [] => String::new(),
    }
}

/// Replaces names by indices, the root first, known basic types added where they are missing.
fn resolve(root: &str, mut structs: Vec<Struct<String>>) -> Result<Definition, SchemaError> {
    let at = structs.iter().position(|s| s.name == root).unwrap_or(0);
    if structs.is_empty() {
        return Err(SchemaError::Empty { name: root.to_owned() });
    }
    structs.swap(0, at);
    structs.extend(builtin::basics());
    let mut by_name = BTreeMap::new();
    let mut by_last = BTreeMap::new();
    for (index, one) in structs.iter().enumerate() {
        by_name.entry(one.name.clone()).or_insert(index);
        let last = one.name.rsplit('/').next().unwrap_or_default();
        by_last.entry(last.to_owned()).or_insert(index);
    }
    let find = |name: &str, within: &str| {
        let package = within.split('/').next().unwrap_or_default();
        let found = by_name
            .get(name)
            .or_else(|| by_name.get(&format!("{package}/{name}")))
            .or_else(|| if name.contains('/') { None } else { by_last.get(name) });
        found
            .copied()
            .ok_or_else(|| SchemaError::Undefined { name: name.to_owned(), within: within.to_owned() })
    };
    let structs = structs
        .iter()
        .map(|one| {
            let fields = one
                .fields
                .iter()
                .map(|(name, shape)| Ok((name.clone(), resolve_shape(shape, &|n| find(n, &one.name))?)))
                .collect::<Result<_, SchemaError>>()?;
            Ok(Struct { name: one.name.clone(), fields })
        })
        .collect::<Result<_, SchemaError>>()?;
    Ok(Definition { structs, open_ended: false, packed: false })
}

fn resolve_shape(
    shape: &Shape<String>,
    find: &impl Fn(&str) -> Result<usize, SchemaError>,
) -> Result<Shape<usize>, SchemaError> {
    Ok(match shape {
        Shape::Number(number) => Shape::Number(*number),
        Shape::Text => Shape::Text,
        Shape::WideText => Shape::WideText,
        Shape::Struct(name) => Shape::Struct(find(name)?),
        Shape::Array(count, of) => Shape::Array(*count, Box::new(resolve_shape(of, find)?)),
        Shape::Sequence(of) => Shape::Sequence(Box::new(resolve_shape(of, find)?)),
    })
}
