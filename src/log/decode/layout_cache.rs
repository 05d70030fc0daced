//! Caches field offsets: a message whose lengths equal the previous one's is read without walking it.

use std::ops::Range;

use super::{
    sink::{Numbers, Sink, Slot, number_from, without_terminator},
    template::Template,
};
use crate::log::schema::Number;

/// Where a walk found counts and wanted fields.
///
/// Messages of a channel mostly have lists and texts of the same lengths, so their fields lie at
/// the same places; comparing the counts then replaces the walk. For one program and channel.
#[derive(Debug, Default)]
pub(in crate::log) struct LayoutCache {
    /// Encapsulation of the message that was walked.
    kind: u8,
    /// Places of all counts, and the message there.
    counts: Vec<usize>,
    template: Template,
    fields: Vec<Found>,
    state: State,
    misses: u32,
}

#[derive(Debug, Default, PartialEq, Eq)]
enum State {
    #[default]
    Empty,
    Noting,
    Whole,
}

/// A wanted field and where it lies: from, to.
#[derive(Debug, Clone, Copy)]
pub(in crate::log) enum Found {
    Number(Slot, Number, usize, usize),
    Numbers(Slot, Number, usize, usize),
    Text(Slot, usize, usize),
    Texts(Slot, usize, usize),
    Element(Slot),
}

/// Bytes of a count.
const COUNT: usize = 4;
/// Messages with more counts or fields than this are walked each time.
const MOST: usize = 256;
/// After so many misses in a row the messages are taken to be different each time.
const MOST_MISSES: u32 = 8;

impl LayoutCache {
    /// Reports the fields of a message whose counts are those of the last one; `false` if they
    /// are not, and then what was reported does not count.
    pub(super) fn report(&mut self, kind: u8, body: &[u8], sink: &mut impl Sink) -> bool {
        if self.state != State::Whole {
            return false;
        }
        let hit =
            self.kind == kind && self.template.fits(body) && self.fields(kind == 1, body, sink).is_some();
        self.misses = if hit { 0 } else { self.misses + 1 };
        hit
    }

    fn fields(&self, little_endian: bool, body: &[u8], sink: &mut impl Sink) -> Option<()> {
        sink.element(Slot::MAX);
        for field in &self.fields {
            match *field {
                Found::Number(slot, number, from, to) => {
                    sink.number(slot, number_from(number, little_endian, body.get(from..to)?));
                }
                Found::Numbers(slot, number, from, to) => {
                    let bytes = body.get(from..to)?;
                    sink.numbers(slot, Numbers::Wire { number, little_endian, bytes });
                }
                Found::Text(slot, from, to) => sink.text(slot, without_terminator(body.get(from..to)?)),
                Found::Texts(slot, from, to) => {
                    if sink.expected_texts(slot) != body.get(from..to) {
                        return None;
                    }
                    sink.same_texts(slot);
                }
                Found::Element(slot) => sink.element(slot),
            }
        }
        Some(())
    }

    /// A walk starts.
    pub(super) fn start(&mut self, kind: u8) {
        self.counts.clear();
        self.fields.clear();
        self.kind = kind;
        self.state = if kind <= 1 && self.misses < MOST_MISSES { State::Noting } else { State::Empty };
    }

    /// The walk came to the end of a message that fits.
    pub(super) fn finish(&mut self, body: &[u8]) {
        if self.state == State::Noting
            && let Some(template) = Template::of(body, self.counts())
        {
            self.template = template;
            self.state = State::Whole;
        }
    }

    /// The wanted fields of the last message, and the spans of its counts, if it is little-endian and can be recalled.
    pub(in crate::log) fn learnt(&self) -> Option<(&[Found], impl Iterator<Item = Range<usize>>)> {
        (self.state == State::Whole && self.kind == 1).then(|| (&*self.fields, self.counts()))
    }

    fn counts(&self) -> impl Iterator<Item = Range<usize>> {
        self.counts.iter().map(|&at| at..at + COUNT)
    }

    #[inline]
    pub(super) fn note_count(&mut self, at: usize) {
        if self.state == State::Noting {
            self.counts.push(at);
            self.limit();
        }
    }

    #[inline]
    pub(super) fn note(&mut self, field: Found) {
        if self.state == State::Noting {
            self.fields.push(field);
            self.limit();
        }
    }

    fn limit(&mut self) {
        if self.counts.len() + self.fields.len() > MOST {
            self.state = State::Empty;
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::log::{
        decode::{Program, Want},
        schema::Definition,
    };

    #[derive(Default, Debug, PartialEq)]
    struct Seen(Vec<(Slot, Vec<f64>, String)>);

    impl Sink for Seen {
        fn number(&mut self, slot: Slot, value: f64) {
            self.0.push((slot, vec![value], String::new()));
        }
        fn text(&mut self, slot: Slot, text: &[u8]) {
            self.0.push((slot, Vec::new(), String::from_utf8_lossy(text).into_owned()));
        }
        fn numbers(&mut self, slot: Slot, values: Numbers<'_>) {
            self.0.push((slot, values.to_vec(), String::new()));
        }
        fn element(&mut self, slot: Slot) {
            if slot == Slot::MAX {
                self.0.clear();
            } else {
                self.0.push((slot, Vec::new(), String::new()));
            }
        }
    }

    const TEXT: &str = "float64[] skipped\nstring name\nfloat32[] wanted\nstring other\nfloat64 last";

    fn program() -> Program {
        let definition = Definition::parse("p/msg/M", "ros2msg", TEXT.as_bytes()).unwrap();
        let want = |(slot, path): (Slot, &str)| Want { path: path.into(), slot };
        Program::compile(&definition, &[(0, "name"), (1, "wanted"), (2, "last")].map(want), usize::MAX)
            .unwrap()
    }

    fn message([skipped, name, wanted, other]: [u32; 4], seed: u8) -> Vec<u8> {
        let mut body = Vec::new();
        let mut list = |count: u32, size: usize, fill: u8| {
            body.resize(body.len().next_multiple_of(4), 0);
            body.extend(count.to_le_bytes());
            if count > 0 {
                body.resize(body.len().next_multiple_of(size), 0);
            }
            body.resize(body.len() + count as usize * size, fill);
        };
        list(skipped, 8, seed);
        list(name, 1, b'a' + seed % 20);
        list(wanted, 4, seed);
        list(other, 1, b'z');
        body.resize(body.len().next_multiple_of(8), 0);
        body.extend(f64::from(seed).to_le_bytes());
        [&[0, 1, 0, 0], &body[..]].concat()
    }

    proptest! {
        #[test]
        fn what_is_recalled_is_what_a_walk_finds(
            counts in prop::collection::vec((prop::array::uniform4(0..2_u32), 0..100_u8), 1..40)
        ) {
            let program = program();
            let mut recall = LayoutCache::default();
            for (counts, seed) in counts {
                let message = message(counts, seed);
                let (mut seen, mut walked) = (Seen::default(), Seen::default());
                program.run(&message, &mut recall, &mut seen).unwrap();
                program.run(&message, &mut LayoutCache::default(), &mut walked).unwrap();
                prop_assert_eq!(seen, walked);
            }
        }
    }

    #[test]
    fn equal_counts_are_recalled_and_others_are_not() {
        let (program, mut recall) = (program(), LayoutCache::default());
        program.run(&message([2, 3, 4, 5], 1), &mut recall, &mut Seen::default()).unwrap();
        let mut hit = |counts| recall.report(1, &message(counts, 7)[4..], &mut Seen::default());
        assert!(hit([2, 3, 4, 5]));
        assert!(!hit([2, 4, 4, 5]));
        assert!(!hit([2, 3, 5, 5]));
    }
}
