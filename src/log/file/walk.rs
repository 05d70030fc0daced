//! A way through the bytes of a file that reads little of what it passes over.

use std::io;

use super::{record::Opcode, source::Source, span::Span};

/// Read at a time; a record's head and the start of its body.
const WINDOW: u64 = 1 << 14;
/// Opcode and length.
pub(super) const HEAD: u64 = 9;
/// Of a body, as much as checks of it look at.
const LOOK: u64 = 256;
/// Read at a time of what only a checksum is wanted of.
const PIECE: u64 = 1 << 16;

/// A record: its type, and where its body is. The next one starts where that ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Found {
    pub(super) opcode: u8,
    pub(super) body: Span,
}

/// Looks at a file through a window that moves along.
pub(super) struct Walk<'a> {
    source: &'a Source,
    start: u64,
    bytes: Vec<u8>,
    /// Why the file system refused bytes, once it has.
    fault: Option<io::Error>,
}

impl<'a> Walk<'a> {
    pub(super) fn of(source: &'a Source) -> Self {
        Self { source, start: 0, bytes: Vec::new(), fault: None }
    }

    pub(super) fn length(&self) -> u64 {
        self.source.length()
    }

    /// The fault, if there was one: what lies behind it was taken for the end of the file.
    pub(super) fn into_fault(self) -> Option<io::Error> {
        self.fault
    }

    /// Bytes from `at` on: `count` of them, or more; fewer where the file ends.
    pub(super) fn from(&mut self, at: u64, count: u64) -> &[u8] {
        let there = self.start + self.bytes.len() as u64;
        let wanted = at.saturating_add(count).min(self.length());
        if at < self.start || wanted > there {
            self.start = at;
            let span = Span { start: at, end: at.saturating_add(count.max(WINDOW)) };
            if let Err(error) = self.source.read(span, &mut self.bytes) {
                self.fault.get_or_insert(error);
            }
        }
        usize::try_from(at - self.start).ok().and_then(|from| self.bytes.get(from..)).unwrap_or_default()
    }

    /// Exactly these bytes, or fewer where the file ends.
    fn exactly(&mut self, at: u64, count: u64) -> &[u8] {
        let bytes = self.from(at, count);
        usize::try_from(count).ok().and_then(|count| bytes.get(..count)).unwrap_or(bytes)
    }

    pub(super) fn starts_with(&mut self, at: u64, start: &[u8]) -> bool {
        self.from(at, start.len() as u64).starts_with(start)
    }

    fn head(&mut self, at: u64) -> Option<(u8, u64)> {
        let [opcode, length @ ..] = self.from(at, HEAD).first_chunk::<9>()?;
        Some((*opcode, u64::from_le_bytes(*length)))
    }

    /// The record at `at`, if all of it is there.
    pub(super) fn record(&mut self, at: u64) -> Option<Found> {
        let (opcode, length) = self.head(at)?;
        let start = at + HEAD;
        let end = start.checked_add(length).filter(|end| *end <= self.length())?;
        Some(Found { opcode, body: Span { start, end } })
    }

    /// A record that the file ends within, and the length that it says.
    pub(super) fn cut_record(&mut self, at: u64) -> Option<(Found, u64)> {
        let (opcode, length) = self.head(at)?;
        let body = Span { start: at + HEAD, end: self.length() };
        (length > body.length()).then_some((Found { opcode, body }, length))
    }

    /// The start of a body: enough to judge it by.
    pub(super) fn look(&mut self, body: Span) -> &[u8] {
        let span = body.first(LOOK);
        self.exactly(span.start, span.length())
    }

    /// All of a body; nothing if it cannot be read.
    pub(super) fn body(&mut self, body: Span) -> Vec<u8> {
        let mut bytes = Vec::new();
        if let Err(error) = self.source.read(body, &mut bytes) {
            self.fault.get_or_insert(error);
        }
        bytes
    }

    /// Checksum of a span, if all of it is there.
    pub(super) fn crc(&mut self, span: Span) -> Option<u32> {
        let (mut hash, mut bytes, mut at) = (crc32fast::Hasher::new(), Vec::new(), span.start);
        while at < span.end {
            let piece = Span { start: at, end: span.end.min(at + PIECE) };
            if let Err(error) = self.source.read(piece, &mut bytes) {
                self.fault.get_or_insert(error);
            }
            hash.update(&bytes);
            at += bytes.len() as u64;
            if bytes.is_empty() {
                return None;
            }
        }
        Some(hash.finalize())
    }

    /// The next place from `at` on that could be the start of a record by its first byte.
    pub(super) fn next_candidate(&mut self, at: u64) -> Option<u64> {
        self.next_byte(at, |byte| (Opcode::FOOTER..=Opcode::DATA_END).contains(&byte))
    }

    /// The next place from `at` on with such a byte.
    pub(super) fn next_byte(&mut self, mut at: u64, is_such: impl Fn(u8) -> bool) -> Option<u64> {
        loop {
            let bytes = self.from(at, 1);
            if bytes.is_empty() {
                return None;
            }
            match bytes.iter().position(|byte| is_such(*byte)) {
                Some(further) => return Some(at + further as u64),
                None => at += bytes.len() as u64,
            }
        }
    }
}
