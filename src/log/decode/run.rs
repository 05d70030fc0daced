//! Walks the bytes of one message along a program.

use thiserror::Error;

use super::{
    program::{Program, Step},
    sink::{Numbers, Sink, Texts, number_from, without_terminator},
};

/// Why the bytes of a message do not fit its program.
#[derive(Debug, Clone, Copy, Error, PartialEq, Eq)]
#[non_exhaustive]
pub(in crate::log) enum RunError {
    /// Shorter than the four bytes that say how it is encoded.
    #[error("message of {bytes} bytes has no encapsulation header")]
    NoHeader { bytes: usize },
    /// An encapsulation that is not read.
    #[error("encapsulation {kind:#06x} is not CDR, XCDR2 or delimited XCDR2")]
    Encapsulation { kind: u16 },
    /// Bytes run out.
    #[error("message ends at byte {end} where {needed} more bytes belong at {at}")]
    Short { at: usize, needed: u64, end: usize },
    /// A list is not as long as it says.
    #[error("the list that ends at byte {at} should end at {end}")]
    ListSize { at: usize, end: usize },
    /// Bytes are left over.
    #[error("{left} bytes follow the last field")]
    Long { left: usize },
}

/// Which sizes precede structs and lists of structs: none in classic CDR.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Sizes {
    of_structs: bool,
    of_lists: bool,
}

const NO_SIZES: Sizes = Sizes { of_structs: false, of_lists: false };

/// Bytes after the last field that are padding.
const MAX_PADDING: usize = 7;

impl Program {
    /// Reports the wanted fields of one message to `sink`.
    ///
    /// On an error some fields may have been reported already; the sink must drop them.
    pub(in crate::log) fn run(&self, message: &[u8], sink: &mut impl Sink) -> Result<(), RunError> {
        let Some((&[zero, kind, _, _], body)) = message.split_first_chunk::<4>() else {
            return Err(RunError::NoHeader { bytes: message.len() });
        };
        let mut walk = |little_endian, widest, sizes| self.walk(body, little_endian, widest, sizes, sink);
        match (zero, kind) {
            (0, 0) => walk(false, 8, NO_SIZES),
            (0, 1) => walk(true, 8, NO_SIZES),
            // XCDR2, plain: lists of structs carry their size; some writers leave it out.
            (0, 0x06 | 0x07 | 0x10 | 0x11) => {
                let little = kind & 1 == 1;
                walk(little, 4, Sizes { of_structs: false, of_lists: true })
                    .or_else(|_| walk(little, 4, NO_SIZES))
            }
            // XCDR2, delimited: structs carry theirs too.
            (0, 0x08 | 0x09 | 0x14 | 0x15) => {
                let little = kind & 1 == 1;
                walk(little, 4, Sizes { of_structs: true, of_lists: true })
                    .or_else(|_| walk(little, 4, NO_SIZES))
            }
            _ => Err(RunError::Encapsulation { kind: u16::from_be_bytes([zero, kind]) }),
        }
    }

    fn walk<S: Sink>(
        &self,
        body: &[u8],
        little_endian: bool,
        widest: u8,
        sizes: Sizes,
        sink: &mut S,
    ) -> Result<(), RunError> {
        let mut reader = Reader { body, at: 0, widest, sizes };
        sink.element(super::sink::Slot::MAX);
        if little_endian {
            reader.steps::<true, S>(&self.steps, sink)?;
        } else {
            reader.steps::<false, S>(&self.steps, sink)?;
        }
        let left = body.len().saturating_sub(reader.at);
        if left > MAX_PADDING && !self.open_ended { Err(RunError::Long { left }) } else { Ok(()) }
    }
}

struct Reader<'a> {
    body: &'a [u8],
    at: usize,
    widest: u8,
    sizes: Sizes,
}

impl<'a> Reader<'a> {
    #[inline]
    fn align(&mut self, to: u8) {
        let mask = usize::from(to.min(self.widest)) - 1;
        self.at = (self.at + mask) & !mask;
    }

    #[inline]
    fn take(&mut self, bytes: u64) -> Result<&'a [u8], RunError> {
        let found = usize::try_from(bytes).ok().and_then(|n| self.body.get(self.at..)?.get(..n));
        match found {
            Some(piece) => {
                self.at += piece.len();
                Ok(piece)
            }
            None => Err(RunError::Short { at: self.at, needed: bytes, end: self.body.len() }),
        }
    }

    #[inline]
    fn length<const LITTLE: bool>(&mut self) -> Result<u32, RunError> {
        self.align(4);
        let bytes = self.take(4)?.try_into().unwrap_or_default();
        Ok(if LITTLE { u32::from_le_bytes(bytes) } else { u32::from_be_bytes(bytes) })
    }

    fn count<const LITTLE: bool>(&mut self, fixed: Option<u32>) -> Result<u32, RunError> {
        match fixed {
            Some(count) => Ok(count),
            None => self.length::<LITTLE>(),
        }
    }

    fn numbers(&mut self, size: u8, count: u32) -> Result<&'a [u8], RunError> {
        if count == 0 {
            return Ok(&[]); // No padding before an element that is not there.
        }
        self.align(size);
        self.take(u64::from(count) * u64::from(size))
    }

    fn steps<const LITTLE: bool, S: Sink>(&mut self, steps: &[Step], sink: &mut S) -> Result<(), RunError> {
        let mut next = 0;
        while let Some(step) = steps.get(next) {
            next += 1;
            match *step {
                Step::Skip { align, bytes } => {
                    self.align(align);
                    self.take(u64::from(bytes))?;
                }
                Step::SkipText => {
                    let length = self.length::<LITTLE>()?;
                    self.take(u64::from(length))?;
                }
                Step::SkipWideText => {
                    let length = self.length::<LITTLE>()?;
                    self.take(2 * u64::from(length))?;
                }
                Step::SkipNumbers(number) => {
                    let count = self.length::<LITTLE>()?;
                    self.numbers(number.size(), count)?;
                }
                Step::Number { slot, number } => {
                    let piece = self.numbers(number.size(), 1)?;
                    sink.number(slot, number_from(number, LITTLE, piece));
                }
                Step::Text(slot) => {
                    let length = self.length::<LITTLE>()?;
                    sink.text(slot, without_terminator(self.take(u64::from(length))?));
                }
                Step::Numbers { slot, number, count } => {
                    let count = self.count::<LITTLE>(count)?;
                    let bytes = self.numbers(number.size(), count)?;
                    sink.numbers(slot, Numbers::Wire { number, little_endian: LITTLE, bytes });
                }
                Step::Texts { slot, count } => self.texts::<LITTLE, S>(slot, count, sink)?,
                Step::Repeat { slot, count, steps: inner, least } => {
                    let end = next + inner as usize;
                    self.repeat::<LITTLE, S>(slot, count, least, &steps[next..end.min(steps.len())], sink)?;
                    next = end;
                }
                Step::StructStart => {
                    if self.sizes.of_structs {
                        self.length::<LITTLE>()?;
                    }
                }
            }
        }
        Ok(())
    }

    fn texts<const LITTLE: bool, S: Sink>(
        &mut self,
        slot: u8,
        fixed: Option<u32>,
        sink: &mut S,
    ) -> Result<(), RunError> {
        let end = self.list_end::<LITTLE>()?;
        self.align(4);
        let start = self.at;
        if fixed.is_none()
            && let Some(expected) = sink.expected_texts(slot)
            && self.body.get(start..).is_some_and(|rest| rest.starts_with(expected))
        {
            self.at += expected.len();
            sink.same_texts(slot);
            return self.check_end(end);
        }
        let count = self.count::<LITTLE>(fixed)?;
        for _ in 0..count {
            let length = self.length::<LITTLE>()?;
            self.take(u64::from(length))?;
        }
        if fixed.is_none() {
            let raw = &self.body[start..self.at];
            sink.texts(slot, Texts::Wire { little_endian: LITTLE, count: count as usize, raw });
        }
        self.check_end(end)
    }

    fn repeat<const LITTLE: bool, S: Sink>(
        &mut self,
        slot: Option<u8>,
        fixed: Option<u32>,
        least: u64,
        steps: &[Step],
        sink: &mut S,
    ) -> Result<(), RunError> {
        let end = self.list_end::<LITTLE>()?;
        let count = self.count::<LITTLE>(fixed)?;
        // Checked before walking: a count cannot ask for more elements than bytes can hold.
        let needed = u64::from(count).saturating_mul(least);
        let left = (self.body.len() - self.at.min(self.body.len())) as u64;
        if needed > left {
            return Err(RunError::Short { at: self.at, needed, end: self.body.len() });
        }
        for _ in 0..count {
            if let Some(slot) = slot {
                sink.element(slot);
            }
            self.steps::<LITTLE, S>(steps, sink)?;
        }
        self.check_end(end)
    }

    /// Where a list ends, if its size precedes it.
    fn list_end<const LITTLE: bool>(&mut self) -> Result<Option<usize>, RunError> {
        if !self.sizes.of_lists {
            return Ok(None);
        }
        let size = self.length::<LITTLE>()? as usize;
        Ok(Some(self.at.saturating_add(size)))
    }

    fn check_end(&self, end: Option<usize>) -> Result<(), RunError> {
        match end {
            Some(end) if end != self.at => Err(RunError::ListSize { at: self.at, end }),
            _ => Ok(()),
        }
    }
}
