//! A second opinion on messages: decodes CDR by nothing but the definition in the log.

use std::collections::BTreeMap;

use mcap::Message;

#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Value {
    Number(f64),
    Text(String),
    List(Vec<Value>),
    Record(BTreeMap<String, Value>),
}

impl Value {
    /// A field, or a field of a field: `reference.positions`.
    pub(crate) fn at(&self, path: &str) -> &Value {
        path.split('.').fold(self, |value, name| match value {
            Value::Record(fields) => &fields[name],
            other => panic!("no {name} in {other:?}"),
        })
    }

    pub(crate) fn number(&self) -> f64 {
        let Value::Number(number) = self else { panic!("{self:?} is no number") };
        *number
    }

    pub(crate) fn text(&self) -> &str {
        let Value::Text(text) = self else { panic!("{self:?} is no text") };
        text
    }

    pub(crate) fn list(&self) -> &[Value] {
        let Value::List(list) = self else { panic!("{self:?} is no list") };
        list
    }

    pub(crate) fn numbers(&self) -> Vec<f64> {
        self.list().iter().map(Value::number).collect()
    }

    pub(crate) fn texts(&self) -> Vec<&str> {
        self.list().iter().map(Value::text).collect()
    }

    /// `Time` and `Duration`, ns.
    pub(crate) fn time_ns(&self) -> i64 {
        (self.at("sec").number() * 1e9) as i64 + self.at("nanosec").number() as i64
    }
}

/// Decodes a message to its last byte.
pub(crate) fn decode(message: &Message) -> Value {
    let schema = message.channel.schema.as_ref().unwrap();
    assert_eq!(schema.encoding, "ros2msg");
    assert_eq!(message.channel.message_encoding, "cdr");
    let text = std::str::from_utf8(&schema.data).unwrap();
    let mut definitions = BTreeMap::new();
    for (k, part) in text.split(&format!("{}\n", "=".repeat(80))).enumerate() {
        let (name, fields) = match part.strip_prefix("MSG: ") {
            Some(named) => named.split_once('\n').unwrap(),
            None => ("", part),
        };
        assert_eq!(name.is_empty(), k == 0);
        definitions.insert(name, fields);
    }
    assert_eq!(message.data[..4], [0, 1, 0, 0]);
    let mut reader = Reader { body: &message.data[4..], at: 0, definitions };
    let value = reader.record("");
    assert_eq!(reader.at, reader.body.len(), "bytes left over");
    value
}

struct Reader<'a> {
    body: &'a [u8],
    at: usize,
    definitions: BTreeMap<&'a str, &'a str>,
}

impl<'a> Reader<'a> {
    fn take<const N: usize>(&mut self) -> [u8; N] {
        self.at = self.at.div_ceil(N) * N + N;
        self.body[self.at - N..self.at].try_into().unwrap()
    }

    fn count(&mut self) -> usize {
        let count = u32::from_le_bytes(self.take()) as usize;
        assert!(count <= self.body.len(), "{count} elements in {} bytes", self.body.len());
        count
    }

    fn record(&mut self, name: &str) -> Value {
        let definition: &'a str = self.definitions[name];
        let lines = definition.lines().filter(|line| !line.starts_with('#') && !line.is_empty());
        let fields = lines.map(|line| {
            let (kind, field) = line.split_once(' ').unwrap();
            (field.to_owned(), self.field(kind))
        });
        Value::Record(fields.collect())
    }

    fn field(&mut self, kind: &str) -> Value {
        if let Some(element) = kind.strip_suffix("[]") {
            return Value::List((0..self.count()).map(|_| self.field(element)).collect());
        }
        match kind {
            "float64" => Value::Number(f64::from_le_bytes(self.take())),
            "int32" => Value::Number(f64::from(i32::from_le_bytes(self.take()))),
            "uint32" => Value::Number(f64::from(u32::from_le_bytes(self.take()))),
            "string" => {
                let length = self.count();
                let bytes = &self.body[self.at..self.at + length];
                self.at += length;
                let text = bytes.strip_suffix(&[0]).unwrap();
                Value::Text(String::from_utf8(text.to_vec()).unwrap())
            }
            name => self.record(name),
        }
    }
}
