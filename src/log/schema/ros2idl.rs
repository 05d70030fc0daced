//! The subset of OMG IDL that ROS 2 generates: modules, structs, typedefs, enums, constants,
//! annotations. Each file, the root too, follows a line of `=` and a line `IDL: package/msg/Type`.

use std::collections::BTreeMap;

use super::{Number, SchemaError, Shape, Struct, plain_name};

pub(super) fn parse(text: &str) -> Result<Vec<Struct<String>>, SchemaError> {
    let plain: String = text
        .lines()
        .filter(|line| {
            let line = line.trim_start();
            !(line.starts_with('#') || line.starts_with("IDL:") || line.starts_with("===="))
        })
        .fold(String::with_capacity(text.len()), |all, line| all + line + "\n");
    let mut parser = Parser { words: words(&plain), at: 0, structs: Vec::new(), aliases: BTreeMap::new() };
    while parser.at < parser.words.len() {
        parser.item(&mut Vec::new())?;
    }
    let Parser { mut structs, aliases, .. } = parser;
    for one in &mut structs {
        for (_, shape) in &mut one.fields {
            expand(shape, &aliases, 0);
        }
        if one.fields.is_empty() {
            one.fields.push(("structure_needs_at_least_one_member".into(), Shape::Number(Number::U8)));
        }
    }
    Ok(structs)
}

/// Identifiers (with `::`), numbers, string literals and single punctuation marks.
fn words(text: &str) -> Vec<&str> {
    let mut words = Vec::new();
    let mut rest = text;
    loop {
        rest = rest.trim_start();
        let Some(first) = rest.chars().next() else { return words };
        let length = if rest.starts_with("//") {
            rest = rest.split_once('\n').map_or("", |(_, after)| after);
            continue;
        } else if rest.starts_with("/*") {
            rest = rest.split_once("*/").map_or("", |(_, after)| after);
            continue;
        } else if first == '"' {
            let mut escaped = false;
            rest[1..]
                .find(|c| {
                    let ends = c == '"' && !escaped;
                    escaped = c == '\\' && !escaped;
                    ends
                })
                .map_or(rest.len(), |at| at + 2)
        } else if first.is_alphanumeric() || first == '_' || rest.starts_with("::") {
            rest.find(|c: char| !(c.is_alphanumeric() || "_:.".contains(c))).unwrap_or(rest.len())
        } else {
            first.len_utf8()
        };
        let (word, after) = rest.split_at(length.max(1));
        words.push(word);
        rest = after;
    }
}

struct Parser<'a> {
    words: Vec<&'a str>,
    at: usize,
    structs: Vec<Struct<String>>,
    aliases: BTreeMap<String, Shape<String>>,
}

/// Deepest nesting of modules and types; ROS 2 generates three. Low, because a name of three
/// letters can stand for all of it.
const MAX_DEPTH: usize = 8;

impl<'a> Parser<'a> {
    fn peek(&self) -> &'a str {
        self.words.get(self.at).copied().unwrap_or_default()
    }

    fn next(&mut self) -> &'a str {
        let word = self.peek();
        self.at += 1;
        word
    }

    fn expect(&mut self, mark: &'static str) -> Result<(), SchemaError> {
        let found = self.next();
        if found == mark { Ok(()) } else { Err(unexpected(found, mark)) }
    }

    fn skip_annotations(&mut self) {
        while self.peek() == "@" {
            self.at += 2;
            if self.peek() == "(" {
                self.skip_past(")");
            }
        }
    }

    /// Skips to after the mark that closes what opens here, nested parentheses included.
    fn skip_past(&mut self, mark: &str) {
        let mut depth = 0_usize;
        while self.at < self.words.len() {
            let word = self.next();
            match word {
                "(" | "{" => depth += 1,
                ")" | "}" => depth = depth.saturating_sub(1),
                _ => {}
            }
            if word == mark && depth == 0 {
                return;
            }
        }
    }

    fn item(&mut self, scope: &mut Vec<&'a str>) -> Result<(), SchemaError> {
        self.skip_annotations();
        match self.next() {
            "module" if scope.len() < MAX_DEPTH => {
                scope.push(self.next());
                self.expect("{")?;
                while self.peek() != "}" {
                    if self.at >= self.words.len() {
                        return Err(unexpected("", "} at the end of a module"));
                    }
                    self.item(scope)?;
                }
                self.at += 1;
                scope.pop();
            }
            "struct" => {
                let name = self.next();
                self.expect("{")?;
                let mut fields = Vec::new();
                loop {
                    self.skip_annotations();
                    if self.peek() == "}" {
                        self.at += 1;
                        break;
                    }
                    self.members(&mut fields)?;
                }
                let name = plain_name(&[&scope[..], &[name]].concat().join("/"));
                self.structs.push(Struct { name, fields });
            }
            "typedef" => {
                let mut fields = Vec::new();
                self.members(&mut fields)?;
                self.aliases.extend(fields);
            }
            "enum" => {
                let name = self.next().to_owned();
                self.aliases.insert(name, Shape::Number(Number::U32));
                self.skip_past("}");
            }
            "const" => self.skip_past(";"),
            ";" | "" => {}
            other => return Err(unexpected(other, "module, struct, typedef, enum or const")),
        }
        if self.peek() == ";" {
            self.at += 1;
        }
        Ok(())
    }

    /// `type a, b[3];`
    fn members(&mut self, fields: &mut Vec<(String, Shape<String>)>) -> Result<(), SchemaError> {
        let of = self.shape(0)?;
        loop {
            let name = self.next();
            if !name.starts_with(|c: char| c.is_alphabetic() || c == '_') {
                return Err(unexpected(name, "a field name"));
            }
            let mut shape = of.clone();
            let mut dimensions = 0;
            while self.peek() == "[" {
                dimensions += 1;
                if dimensions > MAX_DEPTH {
                    return Err(unexpected("[", "an array of fewer dimensions"));
                }
                self.at += 1;
                let count = self.next();
                let count = count.parse().map_err(|_| unexpected(count, "an array length"))?;
                self.expect("]")?;
                shape = Shape::Array(count, Box::new(shape));
            }
            fields.push((name.to_owned(), shape));
            match self.next() {
                "," => {}
                ";" => return Ok(()),
                other => return Err(unexpected(other, "; after a field")),
            }
        }
    }

    fn shape(&mut self, depth: usize) -> Result<Shape<String>, SchemaError> {
        let word = self.next();
        Ok(match word {
            "sequence" if depth < MAX_DEPTH => {
                self.expect("<")?;
                let of = self.shape(depth + 1)?;
                if self.peek() == "," {
                    self.at += 2;
                }
                self.expect(">")?;
                Shape::Sequence(Box::new(of))
            }
            "string" | "wstring" => {
                if self.peek() == "<" {
                    self.at += 2;
                    self.expect(">")?;
                }
                if word == "string" { Shape::Text } else { Shape::WideText }
            }
            "boolean" => Shape::Number(Number::Bool),
            "octet" | "uint8" | "char" => Shape::Number(Number::U8),
            "int8" => Shape::Number(Number::I8),
            "short" | "int16" => Shape::Number(Number::I16),
            "uint16" => Shape::Number(Number::U16),
            "int32" => Shape::Number(Number::I32),
            "uint32" => Shape::Number(Number::U32),
            "int64" => Shape::Number(Number::I64),
            "uint64" => Shape::Number(Number::U64),
            "float" => Shape::Number(Number::F32),
            "double" => Shape::Number(Number::F64),
            "long" | "unsigned" => Shape::Number(self.long(word == "unsigned")?),
            name if name.starts_with(|c: char| c.is_alphabetic() || c == ':' || c == '_') => {
                Shape::Struct(if name.contains(':') { plain_name(name) } else { name.to_owned() })
            }
            other => return Err(unexpected(other, "a type")),
        })
    }

    /// After `long` or `unsigned`.
    fn long(&mut self, unsigned: bool) -> Result<Number, SchemaError> {
        if unsigned {
            match self.next() {
                "short" => return Ok(Number::U16),
                "long" => {}
                other => return Err(unexpected(other, "short or long after unsigned")),
            }
        }
        let longer = self.peek() == "long";
        self.at += usize::from(longer);
        if self.peek() == "double" {
            return Err(unexpected("long double", "a type of at most eight bytes"));
        }
        Ok(match (unsigned, longer) {
            (false, false) => Number::I32,
            (false, true) => Number::I64,
            (true, false) => Number::U32,
            (true, true) => Number::U64,
        })
    }
}

fn unexpected(found: &str, expected: &'static str) -> SchemaError {
    SchemaError::Unexpected { found: found.to_owned(), expected }
}

/// Replaces typedef names by their types.
fn expand(shape: &mut Shape<String>, aliases: &BTreeMap<String, Shape<String>>, depth: usize) {
    match shape {
        Shape::Array(_, of) | Shape::Sequence(of) if depth < MAX_DEPTH => expand(of, aliases, depth + 1),
        Shape::Struct(name) if depth < MAX_DEPTH => {
            let last = name.rsplit('/').next().unwrap_or_default();
            if let Some(meaning) = aliases.get(last) {
                *shape = meaning.clone();
                expand(shape, aliases, depth + 1);
            }
        }
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_ros_2_generates_is_understood() {
        let text = r#"
================================================================================
IDL: pkg/msg/Thing
// generated
#include "std_msgs/msg/Header.idl"
module pkg {
  module msg {
    typedef double double__3[3];
    module Thing_Constants { const uint8 MODE = 1; };
    @verbatim (language="comment", text="a (b) } ;" "more")
    struct Thing {
      std_msgs::msg::Header header;
      @default (value=5)
      long count;
      unsigned long long big;
      sequence<double> values;
      sequence<string<8>, 4> names;
      double__3 axis;
      @unit("m") pkg::msg::Other other;
    };
  };
};
================================================================================
IDL: pkg/msg/Other
module pkg { module msg { struct Other { octet structure_needs_at_least_one_member; }; }; };
"#;
        let structs = parse(text).unwrap();
        assert_eq!(structs[0].name, "pkg/Thing");
        let shapes: Vec<_> = structs[0].fields.iter().map(|(_, shape)| shape.clone()).collect();
        assert_eq!(shapes[0], Shape::Struct("std_msgs/Header".into()));
        assert_eq!(shapes[1], Shape::Number(Number::I32));
        assert_eq!(shapes[2], Shape::Number(Number::U64));
        assert_eq!(shapes[3], Shape::Sequence(Box::new(Shape::Number(Number::F64))));
        assert_eq!(shapes[4], Shape::Sequence(Box::new(Shape::Text)));
        assert_eq!(shapes[5], Shape::Array(3, Box::new(Shape::Number(Number::F64))));
        assert_eq!(shapes[6], Shape::Struct("pkg/Other".into()));
        assert_eq!(structs[1].name, "pkg/Other");
    }

    #[test]
    fn an_unclosed_struct_is_an_error_not_a_hang() {
        assert!(parse("module a { struct B { double x;").is_err());
        assert!(parse("module a {").is_err());
        assert!(parse("@@@@@@ ( ( (").is_ok());
    }
}
