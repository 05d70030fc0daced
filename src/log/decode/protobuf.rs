//! Protobuf: descriptors and messages, read only as far as somebody wants their fields.
//!
//! Our own, because descriptors come with the file: what libraries do with hostile ones includes
//! panics. (<https://protobuf.dev/programming-guides/encoding/>, `descriptor.proto`.)

use std::collections::BTreeMap;

use serde_json::{Map, Number, Value};

/// One field as it lies on the wire.
#[derive(Debug, Clone, Copy)]
enum Wire<'a> {
    Varint(u64),
    Eight([u8; 8]),
    Four([u8; 4]),
    Bytes(&'a [u8]),
}

/// The fields of a message one after another: number and content.
struct Fields<'a>(&'a [u8]);

impl<'a> Fields<'a> {
    /// `Ok(None)` at the end, `Err` where the bytes are no field.
    fn next(&mut self) -> Result<Option<(u64, Wire<'a>)>, String> {
        if self.0.is_empty() {
            return Ok(None);
        }
        let left = self.0.len();
        self.field().map(Some).ok_or_else(|| format!("no Protobuf field {left} bytes before its end"))
    }

    fn field(&mut self) -> Option<(u64, Wire<'a>)> {
        let tag = self.varint()?;
        let wire = match tag & 7 {
            0 => Wire::Varint(self.varint()?),
            1 => Wire::Eight(self.take(8)?.try_into().ok()?),
            2 => {
                let length = usize::try_from(self.varint()?).ok()?;
                Wire::Bytes(self.take(length)?)
            }
            5 => Wire::Four(self.take(4)?.try_into().ok()?),
            _ => return None,
        };
        Some((tag >> 3, wire))
    }

    fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let (head, rest) = self.0.split_at_checked(count)?;
        self.0 = rest;
        Some(head)
    }

    fn varint(&mut self) -> Option<u64> {
        let mut value = 0;
        for (place, &byte) in self.0.iter().take(10).enumerate() {
            value |= u64::from(byte & 0x7f) << (7 * place);
            if byte < 0x80 {
                self.0 = &self.0[place + 1..];
                return Some(value);
            }
        }
        None
    }
}

/// A field as its descriptor has it.
#[derive(Debug, Clone, Default)]
struct Field {
    name: String,
    number: u64,
    /// `FieldDescriptorProto.Type`.
    kind: u64,
    /// Full name of its message type.
    of: String,
    repeated: bool,
    /// Absent means zero.
    implicit: bool,
}

/// All messages of a file descriptor set by their full names.
#[derive(Debug, Clone, Default)]
pub(super) struct Descriptors(BTreeMap<String, Vec<Field>>);

/// Deepest nesting of messages within messages.
const MAX_DEPTH: usize = 16;

impl Descriptors {
    pub(super) fn parse(set: &[u8]) -> Result<Self, String> {
        let mut all = Self::default();
        let mut files = Fields(set);
        while let Some(field) = files.next()? {
            let (1, Wire::Bytes(file)) = field else { continue };
            let (mut package, mut proto3, mut messages) = (String::new(), false, Vec::new());
            let mut fields = Fields(file);
            while let Some(field) = fields.next()? {
                match field {
                    (2, Wire::Bytes(name)) => package = text(name),
                    (4, Wire::Bytes(message)) => messages.push(message),
                    (12, Wire::Bytes(syntax)) => proto3 = syntax == b"proto3",
                    _ => {}
                }
            }
            for message in messages {
                all.message(message, &package, proto3, 0)?;
            }
        }
        Ok(all)
    }

    /// Adds a `DescriptorProto` and those nested in it.
    fn message(&mut self, bytes: &[u8], scope: &str, proto3: bool, depth: usize) -> Result<(), String> {
        let (mut name, mut nested, mut list) = (String::new(), Vec::new(), Vec::new());
        let mut fields = Fields(bytes);
        while let Some(field) = fields.next()? {
            match field {
                (1, Wire::Bytes(text_of)) => name = text(text_of),
                (2, Wire::Bytes(field)) => list.push(Field::parse(field, proto3)?),
                (3, Wire::Bytes(message)) => nested.push(message),
                _ => {}
            }
        }
        let name = if scope.is_empty() { name } else { format!("{scope}.{name}") };
        if depth >= MAX_DEPTH && !nested.is_empty() {
            return Err(format!("messages nest too deep at {name:?}"));
        }
        for message in nested {
            self.message(message, &name, proto3, depth + 1)?;
        }
        self.0.entry(name).or_insert(list);
        Ok(())
    }

    /// The root, for a message type by its full name; `children` gives the wanted names below.
    pub(super) fn plan<'a, N>(
        &self,
        name: &str,
        node: &'a N,
        children: &impl Fn(&'a N) -> &'a [(String, N)],
    ) -> Option<Vec<Planned>> {
        let known = self.0.get(name)?;
        let wanted = children(node).iter().filter_map(|(name, child)| {
            let field = known.iter().find(|field| field.name == *name)?.clone();
            let below = self.plan(&field.of, child, children).unwrap_or_default();
            Some(Planned { field, below })
        });
        Some(wanted.collect())
    }

    /// Everything but bytes and choices; `left` is how many fields there may be yet.
    fn all(&self, name: &str, depth: usize, left: &mut usize) -> Option<Vec<Planned>> {
        const BYTES: u64 = 12;
        const CHOICE: u64 = 14;
        let mut found = Vec::new();
        for field in self.0.get(name).filter(|_| depth < MAX_DEPTH)? {
            if [BYTES, CHOICE].contains(&field.kind) {
                continue;
            }
            *left = left.checked_sub(1)?;
            let below = if field.of.is_empty() { Vec::new() } else { self.all(&field.of, depth + 1, left)? };
            found.push(Planned { field: field.clone(), below });
        }
        Some(found)
    }
}

impl Field {
    fn parse(bytes: &[u8], proto3: bool) -> Result<Self, String> {
        let mut one = Self { implicit: proto3, ..Self::default() };
        let mut fields = Fields(bytes);
        while let Some(field) = fields.next()? {
            match field {
                (1, Wire::Bytes(name)) => one.name = text(name),
                (3, Wire::Varint(number)) => one.number = number,
                (4, Wire::Varint(label)) => one.repeated = label == 3,
                (5, Wire::Varint(kind)) => one.kind = kind,
                (6, Wire::Bytes(name)) => text(name).trim_start_matches('.').clone_into(&mut one.of),
                // Members of a `oneof`, which includes what is marked `optional`.
                (9, Wire::Varint(_)) => one.implicit = false,
                _ => {}
            }
        }
        Ok(one)
    }
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// A wanted field and the wanted fields of its message.
#[derive(Debug, Clone)]
pub(super) struct Planned {
    field: Field,
    below: Vec<Planned>,
}

/// All numbers and texts of a message type.
#[derive(Debug, Clone)]
pub(in crate::log) struct Whole(Vec<Planned>);

impl Whole {
    /// `None` of a type that the descriptors lack, or that has more fields than messages of joints have.
    pub(in crate::log) fn of(name: &str, descriptors: &[u8]) -> Option<Self> {
        let mut left = 500;
        Descriptors::parse(descriptors).ok()?.all(name, 0, &mut left).map(Self)
    }

    /// A message; `None` of bytes that are none.
    pub(in crate::log) fn value(&self, message: &[u8]) -> Option<Value> {
        object(&self.0, message).ok()
    }
}

/// The wanted fields of a message, as an object.
pub(super) fn object(plan: &[Planned], message: &[u8]) -> Result<Value, String> {
    let mut found = Map::new();
    for Planned { field, .. } in plan {
        let absent = match field.kind {
            _ if field.repeated => Value::Array(Vec::new()),
            9 if field.implicit => Value::String(String::new()),
            1..=8 | 13..=18 if field.implicit => Value::from(0),
            _ => continue,
        };
        found.insert(field.name.clone(), absent);
    }
    let mut fields = Fields(message);
    while let Some((number, wire)) = fields.next()? {
        let Some(one) = plan.iter().find(|one| one.field.number == number) else { continue };
        if let (Some(Value::Array(list)), true) = (found.get_mut(&one.field.name), one.field.repeated) {
            one.append(wire, list)?;
        } else if let Some(value) = one.value(wire)? {
            found.insert(one.field.name.clone(), value);
        }
    }
    Ok(Value::Object(found))
}

impl Planned {
    /// Adds an element, or all of a packed list.
    fn append(&self, wire: Wire<'_>, list: &mut Vec<Value>) -> Result<(), String> {
        let number = !matches!(self.field.kind, 9..=12);
        if let (true, Wire::Bytes(packed)) = (number, wire) {
            let mut rest = Fields(packed);
            while !rest.0.is_empty() {
                let wire = match self.field.kind {
                    1 | 6 | 16 => rest.take(8).and_then(|b| b.try_into().ok()).map(Wire::Eight),
                    2 | 7 | 15 => rest.take(4).and_then(|b| b.try_into().ok()).map(Wire::Four),
                    _ => rest.varint().map(Wire::Varint),
                };
                let wire = wire.ok_or_else(|| format!("the list {:?} breaks off", self.field.name))?;
                list.extend(self.value(wire)?);
            }
        } else {
            list.extend(self.value(wire)?);
        }
        Ok(())
    }

    /// A single value; `None` if the wire holds something else than the descriptor says.
    #[expect(clippy::cast_possible_truncation, reason = "int32 and the like are sent as 64 bits")]
    fn value(&self, wire: Wire<'_>) -> Result<Option<Value>, String> {
        Ok(Some(match (self.field.kind, wire) {
            (1, Wire::Eight(b)) => float(f64::from_le_bytes(b)),
            (2, Wire::Four(b)) => float(f64::from(f32::from_le_bytes(b))),
            (3, Wire::Varint(v)) => v.cast_signed().into(),
            (4, Wire::Varint(v)) => v.into(),
            (5 | 14, Wire::Varint(v)) => (v as u32).cast_signed().into(),
            (6, Wire::Eight(b)) => u64::from_le_bytes(b).into(),
            (7, Wire::Four(b)) => u32::from_le_bytes(b).into(),
            (8, Wire::Varint(v)) => Value::Bool(v != 0),
            (9, Wire::Bytes(b)) => Value::String(text(b)),
            (11, Wire::Bytes(b)) => object(&self.below, b)?,
            (13, Wire::Varint(v)) => (v as u32).into(),
            (15, Wire::Four(b)) => i32::from_le_bytes(b).into(),
            (16, Wire::Eight(b)) => i64::from_le_bytes(b).into(),
            (17 | 18, Wire::Varint(v)) => ((v >> 1).cast_signed() ^ -(v & 1).cast_signed()).into(),
            _ => return Ok(None),
        }))
    }
}

fn float(value: f64) -> Value {
    Number::from_f64(value).map_or_else(|| Value::String("NaN".to_owned()), Value::Number)
}
