//! The numbers and names in messages of a type.

pub(super) use crate::log::source::{NANOSECONDS, SECONDS};
use crate::log::{
    decode::{Slot, Want},
    schema::{Definition, Number, Shape},
};

/// What a leaf holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Second,
    Nanosecond,
    /// One number, or a list of them.
    Number,
    /// A text that names what its struct is of, or a list of those.
    Name,
    /// A list of structs.
    List,
}

/// Leaves of a type, by slot.
#[derive(Debug, Clone, Default)]
pub(super) struct Leaves {
    pub(super) all: Vec<(String, Kind)>,
}

/// A message of joints nests no deeper, has no longer arrays and no more fields.
const MOST_DEPTH: usize = 6;
const MOST_PLACES: u32 = 64;
const MOST_LEAVES: usize = 240;

/// How the numbers of a `MultiArray` lie.
const LAYOUT: &str = "layout";

/// Fields that name what the numbers beside are of.
const NAMES: [&str; 8] =
    ["name", "names", "joint", "joints", "joint_name", "joint_names", "axis", "axis_name"];

impl Leaves {
    /// `None` of a type without numbers, or with more than a message of joints has.
    pub(super) fn of(definition: &Definition) -> Option<Self> {
        let mut leaves = Self::default();
        leaves.gather(definition, 0, "", 0, false)?;
        leaves.all.iter().any(|(_, kind)| *kind == Kind::Number).then_some(leaves)
    }

    pub(super) fn wants(&self) -> Vec<Want> {
        let slots = 0..Slot::MAX;
        self.all.iter().zip(slots).map(|((path, _), slot)| Want { path: path.clone(), slot }).collect()
    }

    fn gather(
        &mut self,
        definition: &Definition,
        at: usize,
        path: &str,
        depth: usize,
        listed: bool,
    ) -> Option<()> {
        if depth > MOST_DEPTH {
            return None;
        }
        let one = definition.structs.get(at)?;
        for (name, shape) in &one.fields {
            if name == LAYOUT {
                continue;
            }
            let path = if path.is_empty() { name.clone() } else { format!("{path}.{name}") };
            let (shape, list) = match shape {
                Shape::Array(count, of) if *count <= MOST_PLACES => (&**of, true),
                Shape::Sequence(of) => (&**of, true),
                Shape::Array(..) => continue,
                other => (other, false),
            };
            match shape {
                // A list of structs in another has no name for its numbers.
                Shape::Struct(_) if list && listed => {}
                Shape::Struct(of) if is_stamp(definition, *of) => {
                    let first = !self.all.iter().any(|(_, kind)| *kind == Kind::Second);
                    self.stamp(definition, *of, &path, first && !list && !listed);
                }
                Shape::Struct(of) => {
                    if list {
                        self.all.push((path.clone(), Kind::List));
                    }
                    self.gather(definition, *of, &path, depth + 1, listed || list)?;
                }
                Shape::Text if NAMES.contains(&name.as_str()) && !(list && listed) => {
                    self.all.push((path, Kind::Name));
                }
                Shape::Number(number) if is_measure(*number) && !(list && listed) => {
                    self.all.push((path, Kind::Number));
                }
                _ => {}
            }
        }
        (self.all.len() <= MOST_LEAVES).then_some(())
    }

    /// Takes an instant for that of the message, if it is `wanted`.
    fn stamp(&mut self, definition: &Definition, at: usize, path: &str, wanted: bool) {
        let Some(one) = definition.structs.get(at).filter(|_| wanted) else { return };
        for (name, _) in &one.fields {
            let kind = if SECONDS.contains(&name.as_str()) { Kind::Second } else { Kind::Nanosecond };
            self.all.push((format!("{path}.{name}"), kind));
        }
    }
}

/// Flags, states and bytes are no positions.
fn is_measure(number: Number) -> bool {
    !matches!(number, Number::Bool | Number::U8 | Number::I8)
}

/// Whether a struct is an instant or a duration: seconds and their parts, and nothing else.
fn is_stamp(definition: &Definition, at: usize) -> bool {
    definition.structs.get(at).is_some_and(|one| {
        let is = |name: &String, of: &[&str]| of.contains(&name.as_str());
        matches!(&one.fields[..], [(second, _), (part, _)] if is(second, &SECONDS) && is(part, &NANOSECONDS))
    })
}
