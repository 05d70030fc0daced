//! Wanted fields of messages that come as a parsed value: JSON, and Protobuf by its descriptor.

use serde_json::Value;

use super::{
    program::Want,
    protobuf::{Descriptors, Planned, object},
    sink::{Numbers, Sink, Slot, Texts},
};

/// Wanted fields as a tree of names, and how a message becomes a value.
#[derive(Debug, Clone)]
pub(in crate::log) struct Tree {
    root: Node,
    protobuf: Option<Vec<Planned>>,
}

#[derive(Debug, Clone, Default)]
struct Node {
    slot: Option<Slot>,
    children: Vec<(String, Node)>,
}

impl Tree {
    /// For messages in JSON.
    pub(in crate::log) fn json(wants: &[Want]) -> Self {
        Self { root: Node::of(wants), protobuf: None }
    }

    /// For messages in Protobuf, described by a file descriptor set; `Err` says what is wrong.
    pub(in crate::log) fn protobuf(name: &str, descriptors: &[u8], wants: &[Want]) -> Result<Self, String> {
        let root = Node::of(wants);
        let plan = Descriptors::parse(descriptors)?
            .plan(name, &root, &|node: &Node| &node.children)
            .ok_or_else(|| format!("no message {name:?} in its descriptors"))?;
        Ok(Self { root, protobuf: Some(plan) })
    }

    /// Reports the wanted fields that the message has; `Err` says why it is no message.
    pub(in crate::log) fn run(&self, message: &[u8], sink: &mut impl Sink) -> Result<(), String> {
        let value = match &self.protobuf {
            None => serde_json::from_slice(message).map_err(|error| error.to_string())?,
            Some(plan) => object(plan, message)?,
        };
        sink.element(Slot::MAX);
        self.root.visit(&value, sink);
        Ok(())
    }
}

impl Node {
    fn of(wants: &[Want]) -> Self {
        let mut root = Self::default();
        for want in wants {
            let mut node = &mut root;
            for name in want.path.split('.') {
                let at = node.children.iter().position(|(child, _)| child == name).unwrap_or_else(|| {
                    node.children.push((name.to_owned(), Self::default()));
                    node.children.len() - 1
                });
                node = &mut node.children[at].1;
            }
            node.slot = Some(want.slot);
        }
        root
    }

    fn visit(&self, value: &Value, sink: &mut impl Sink) {
        match value {
            Value::Object(fields) => {
                for (name, child) in &self.children {
                    if let Some(value) = fields.get(name) {
                        child.visit(value, sink);
                    }
                }
            }
            Value::Array(elements) if !self.children.is_empty() => {
                for element in elements {
                    if let Some(slot) = self.slot {
                        sink.element(slot);
                    }
                    self.visit(element, sink);
                }
            }
            leaf => {
                if let Some(slot) = self.slot {
                    report(slot, leaf, sink);
                }
            }
        }
    }
}

fn report(slot: Slot, leaf: &Value, sink: &mut impl Sink) {
    match leaf {
        Value::Array(elements) if elements.first().is_some_and(|e| e.is_string() && number(e).is_none()) => {
            let texts: Vec<String> =
                elements.iter().map(|e| e.as_str().unwrap_or_default().to_owned()).collect();
            sink.texts(slot, Texts::Parsed(&texts));
        }
        Value::Array(elements) => {
            let values: Vec<f64> = elements.iter().map(|e| number(e).unwrap_or(f64::NAN)).collect();
            sink.numbers(slot, Numbers::Parsed(&values));
        }
        other => match (number(other), other) {
            (Some(value), _) => sink.number(slot, value),
            (None, Value::String(text)) => sink.text(slot, text.as_bytes()),
            _ => {}
        },
    }
}

/// Numbers, and the words JSON writers use for those it cannot express.
fn number(value: &Value) -> Option<f64> {
    match value {
        Value::Number(number) => number.as_f64(),
        Value::Bool(flag) => Some(f64::from(u8::from(*flag))),
        Value::String(text) => match text.as_str() {
            "NaN" => Some(f64::NAN),
            "Infinity" => Some(f64::INFINITY),
            "-Infinity" => Some(f64::NEG_INFINITY),
            _ => None,
        },
        _ => None,
    }
}
