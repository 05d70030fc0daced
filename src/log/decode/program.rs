//! Compiles a definition and a list of wanted fields into steps over CDR bytes.

use thiserror::Error;

use super::sink::Slot;
use crate::log::schema::{Definition, Number, Shape};

/// A field to report: its path from the root (`feedback.positions`, `points.positions` for a
/// field of every element of `points`) and the slot to report it in.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::log) struct Want {
    pub(in crate::log) path: String,
    pub(in crate::log) slot: Slot,
}

/// One step over the bytes of a message.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Step {
    /// Fixed bytes to skip.
    Skip {
        align: u8,
        bytes: u32,
    },
    SkipText,
    SkipWideText,
    /// So many sequences of numbers to skip.
    SkipNumbers {
        number: Number,
        sequences: u32,
    },
    Number {
        slot: Slot,
        number: Number,
    },
    Text(Slot),
    /// A sequence, or an array of `count`.
    Numbers {
        slot: Slot,
        number: Number,
        count: Option<u32>,
    },
    Texts {
        slot: Slot,
        count: Option<u32>,
    },
    /// The following `steps` steps for each element of a sequence or an array of `count`;
    /// an element has at least `least` bytes.
    Repeat {
        slot: Option<Slot>,
        count: Option<u32>,
        steps: u32,
        least: u64,
    },
    /// In the delimited form of XCDR2 a struct is preceded by its size.
    StructStart,
}

/// Why a definition does not compile.
#[derive(Debug, Clone, Error, PartialEq, Eq)]
#[non_exhaustive]
pub(in crate::log) enum ProgramError {
    /// A struct that contains itself, or a tree of structs without end.
    #[error("schema nests too deep or too wide at {name:?}")]
    TooLarge {
        /// The struct at which it was given up.
        name: String,
    },
    /// The path leads nowhere, or to something that is no number or text.
    #[error("no numeric or text field {path:?} in {name:?}; it has {present:?}")]
    NoField {
        /// The path looked for.
        path: String,
        /// The message type.
        name: String,
        /// Fields of the root.
        present: Vec<String>,
    },
}

/// Steps over the bytes of one message type.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::log) struct Program {
    pub(super) steps: Vec<Step>,
    /// The same for the delimited form of XCDR2, with [`Step::StructStart`].
    pub(super) delimited: Vec<Step>,
    /// Whether bytes may follow the last step.
    pub(super) open_ended: bool,
    /// Whether messages are those of ROS 1: no header before, no padding within.
    pub(super) packed: bool,
    /// Cost of compiling: steps, and fields looked at.
    pub(in crate::log) cost: usize,
}

const MAX_COST: usize = 20_000;
const MAX_DEPTH: usize = 64;

impl Program {
    /// Compiles; a wanted path that the definition lacks is an error, and so is a cost above
    /// the caller's or the usual limit.
    pub(in crate::log) fn compile(
        definition: &Definition,
        wants: &[Want],
        most: usize,
    ) -> Result<Self, ProgramError> {
        let compiled = |delimited| {
            let mut compiler = Compiler {
                definition,
                wants,
                found: vec![false; wants.len()],
                steps: Vec::new(),
                closed: 0,
                delimited,
                most: most.min(MAX_COST),
                cost: 0,
            };
            compiler.structure(0, "", 0).map(|_| compiler)
        };
        let (compiler, delimited) = (compiled(false)?, compiled(true)?.steps);
        if let Some(missing) = compiler.found.iter().position(|found| !found) {
            let root = &definition.structs[0];
            return Err(ProgramError::NoField {
                path: wants[missing].path.clone(),
                name: root.name.clone(),
                present: root.fields.iter().map(|(name, _)| name.clone()).collect(),
            });
        }
        let Definition { open_ended, packed, .. } = *definition;
        Ok(Self { steps: compiler.steps, delimited, open_ended, packed, cost: compiler.cost })
    }
}

/// Whether a definition has a field at this path, and its shape; elements of sequences are
/// looked through.
pub(in crate::log) fn shape_at<'a>(definition: &'a Definition, path: &str) -> Option<&'a Shape<usize>> {
    let mut shape: Option<&Shape<usize>> = None;
    let mut within = Some(0);
    for name in path.split('.') {
        let (_, found) = definition.structs.get(within?)?.fields.iter().find(|(field, _)| field == name)?;
        within = struct_inside(found);
        shape = Some(found);
    }
    shape
}

fn struct_inside(shape: &Shape<usize>) -> Option<usize> {
    match shape {
        Shape::Struct(index) => Some(*index),
        Shape::Array(_, of) | Shape::Sequence(of) => struct_inside(of),
        _ => None,
    }
}

struct Compiler<'a> {
    definition: &'a Definition,
    wants: &'a [Want],
    found: Vec<bool>,
    steps: Vec<Step>,
    /// Steps before this one are those of a list's elements, not to be lengthened.
    closed: usize,
    delimited: bool,
    most: usize,
    cost: usize,
}

impl Compiler<'_> {
    fn want(&mut self, path: &str) -> Option<Slot> {
        let at = self.wants.iter().position(|want| want.path == path)?;
        self.found[at] = true;
        Some(self.wants[at].slot)
    }

    /// Appends the steps of a struct; returns the least number of bytes it takes.
    fn structure(&mut self, index: usize, path: &str, depth: usize) -> Result<u64, ProgramError> {
        let definition = self.definition;
        let one = &definition.structs[index];
        // Small texts can describe enormous structs.
        self.cost = self.cost.saturating_add(1 + one.fields.len());
        if depth > MAX_DEPTH || self.cost > self.most {
            return Err(ProgramError::TooLarge { name: one.name.clone() });
        }
        if self.delimited {
            self.steps.push(Step::StructStart);
        }
        let mut least = 0_u64;
        for (name, shape) in &one.fields {
            let path = if path.is_empty() { name.clone() } else { format!("{path}.{name}") };
            least = least.saturating_add(self.field(shape, &path, depth)?);
        }
        Ok(least)
    }

    fn field(&mut self, shape: &Shape<usize>, path: &str, depth: usize) -> Result<u64, ProgramError> {
        let (of, count) = match shape {
            Shape::Array(count, of) => (&**of, Some(Some(*count))),
            Shape::Sequence(of) => (&**of, Some(None)),
            other => (other, None),
        };
        if count == Some(Some(0)) {
            // Every field takes at least a byte; that bounds the walk by the message's length.
            return Err(ProgramError::TooLarge { name: path.to_owned() });
        }
        let wanted = match of {
            Shape::Number(_) | Shape::Text => self.want(path),
            Shape::Struct(_) if count.is_some() => self.want(path),
            _ => None,
        };
        let Some(count) = count else {
            return self.single(of, wanted, path, depth);
        };
        let minimum = |each: u64| count.map_or(4, |n| each.saturating_mul(u64::from(n)));
        Ok(match (of, wanted) {
            (Shape::Number(number), Some(slot)) => {
                self.push(Step::Numbers { slot, number: *number, count });
                minimum(u64::from(number.size()))
            }
            (Shape::Number(number), None) => {
                let size = u32::from(number.size());
                match count {
                    None => self.push(Step::SkipNumbers { number: *number, sequences: 1 }),
                    Some(n) => match n.checked_mul(size) {
                        Some(bytes) => self.push(Step::Skip { align: number.size(), bytes }),
                        None => return Err(ProgramError::TooLarge { name: path.to_owned() }),
                    },
                }
                minimum(u64::from(number.size()))
            }
            (Shape::Text, Some(slot)) => {
                self.push(Step::Texts { slot, count });
                minimum(4)
            }
            _ => {
                let at = self.steps.len();
                self.steps.push(Step::Repeat { slot: wanted, count, steps: 0, least: 1 });
                let each = match of {
                    Shape::Struct(index) => self.structure(*index, path, depth + 1)?,
                    Shape::Array(..) | Shape::Sequence(_) if depth >= MAX_DEPTH => {
                        return Err(ProgramError::TooLarge { name: path.to_owned() });
                    }
                    other => self.field(other, path, depth + 1)?,
                };
                let steps = u32::try_from(self.steps.len() - at - 1).unwrap_or(u32::MAX);
                self.steps[at] = Step::Repeat { slot: wanted, count, steps, least: each.max(1) };
                self.closed = self.steps.len();
                minimum(each)
            }
        })
    }

    fn single(
        &mut self,
        shape: &Shape<usize>,
        wanted: Option<Slot>,
        path: &str,
        depth: usize,
    ) -> Result<u64, ProgramError> {
        Ok(match (shape, wanted) {
            (Shape::Number(number), Some(slot)) => {
                self.push(Step::Number { slot, number: *number });
                u64::from(number.size())
            }
            (Shape::Number(number), None) => {
                self.push(Step::Skip { align: number.size(), bytes: u32::from(number.size()) });
                u64::from(number.size())
            }
            (Shape::Text, Some(slot)) => {
                self.push(Step::Text(slot));
                4
            }
            (Shape::Text, None) => {
                self.push(Step::SkipText);
                4
            }
            (Shape::WideText, _) => {
                self.push(Step::SkipWideText);
                4
            }
            (Shape::Struct(index), _) => self.structure(*index, path, depth + 1)?,
            (Shape::Array(..) | Shape::Sequence(_), _) => 0,
        })
    }

    /// Appends a step, merging neighbouring skips of sequences, and of bytes whose padding is
    /// known to be none.
    fn push(&mut self, step: Step) {
        let last = self.steps.get_mut(self.closed..).and_then(<[Step]>::last_mut);
        match (last, &step) {
            (Some(Step::Skip { align: before, bytes: sum }), Step::Skip { align, bytes })
                if *before >= *align && sum.is_multiple_of(u32::from(*align)) =>
            {
                if let Some(both) = sum.checked_add(*bytes) {
                    *sum = both;
                    return;
                }
            }
            (
                Some(Step::SkipNumbers { number: before, sequences }),
                Step::SkipNumbers { number, sequences: 1 },
            ) if before == number => {
                *sequences += 1;
                return;
            }
            _ => {}
        }
        self.steps.push(step);
    }
}
