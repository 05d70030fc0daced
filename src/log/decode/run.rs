//! Walks the bytes of one message along a program.

use thiserror::Error;

use super::{
    layout_cache::{Found, LayoutCache},
    program::{Program, Step},
    sink::{Numbers, Sink, Slot, Texts, number_from, without_terminator},
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
    /// On an error some fields may have been reported already; the sink must drop them. `cache`
    /// is what was learnt from earlier messages of the same channel.
    pub(in crate::log) fn run(
        &self,
        message: &[u8],
        cache: &mut LayoutCache,
        sink: &mut impl Sink,
    ) -> Result<(), RunError> {
        // What ROS 1 writes is little-endian without a header.
        let header =
            if self.packed { Some((&[0, 1, 0, 0], message)) } else { message.split_first_chunk::<4>() };
        let Some((&[zero, kind, _, _], body)) = header else {
            return Err(RunError::NoHeader { bytes: message.len() });
        };
        if zero == 0 && cache.report(kind, body, sink) {
            return Ok(());
        }
        cache.start(kind);
        let mut walk = |little_endian, widest, sizes| {
            let reader = Reader { body, widest, sizes, cache: &mut *cache };
            self.walk(reader, little_endian, sink)
        };
        match (zero, kind) {
            (0, 0) => walk(false, 8, NO_SIZES),
            (0, 1) => walk(true, if self.packed { 1 } else { 8 }, NO_SIZES),
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

    /// The bytes of a little-endian message without those that say how it is encoded; `None` of any other.
    pub(in crate::log) fn little_endian<'a>(&self, message: &'a [u8]) -> Option<&'a [u8]> {
        if self.packed { Some(message) } else { message.strip_prefix(&[0, 1])?.get(2..) }
    }

    fn walk<S: Sink>(
        &self,
        mut reader: Reader<'_>,
        little_endian: bool,
        sink: &mut S,
    ) -> Result<(), RunError> {
        sink.element(Slot::MAX);
        let steps = if reader.sizes.of_structs { &self.delimited } else { &self.steps };
        let end = if little_endian {
            reader.steps::<true, S>(0, steps, sink)?
        } else {
            reader.steps::<false, S>(0, steps, sink)?
        };
        let left = reader.body.len().saturating_sub(end);
        let padding = if self.packed { 0 } else { MAX_PADDING };
        if left > padding && !self.open_ended {
            return Err(RunError::Long { left });
        }
        reader.cache.finish(reader.body);
        Ok(())
    }
}

/// The bytes of a message. Every method takes the place at which it starts and returns the one
/// at which it ends, so that the place stays in a register.
struct Reader<'a> {
    body: &'a [u8],
    widest: usize,
    sizes: Sizes,
    cache: &'a mut LayoutCache,
}

impl<'a> Reader<'a> {
    #[inline]
    fn align(&self, at: usize, to: u8) -> usize {
        let mask = usize::from(to).min(self.widest) - 1;
        (at + mask) & !mask
    }

    #[inline]
    fn take(&self, at: usize, bytes: u64) -> Result<(&'a [u8], usize), RunError> {
        let end = usize::try_from(bytes).ok().and_then(|bytes| at.checked_add(bytes));
        match end.and_then(|end| Some((self.body.get(at..end)?, end))) {
            Some(found) => Ok(found),
            None => Err(RunError::Short { at, needed: bytes, end: self.body.len() }),
        }
    }

    #[inline]
    fn skip(&self, at: usize, bytes: u64) -> Result<usize, RunError> {
        self.take(at, bytes).map(|(_, end)| end)
    }

    #[inline]
    fn length<const LITTLE: bool>(&mut self, at: usize) -> Result<(u32, usize), RunError> {
        let (bytes, end) = self.take(self.align(at, 4), 4)?;
        let bytes = bytes.try_into().unwrap_or_default();
        self.cache.note_count(end - 4);
        Ok((if LITTLE { u32::from_le_bytes(bytes) } else { u32::from_be_bytes(bytes) }, end))
    }

    #[inline]
    fn count<const LITTLE: bool>(&mut self, at: usize, fixed: Option<u32>) -> Result<(u32, usize), RunError> {
        match fixed {
            Some(count) => Ok((count, at)),
            None => self.length::<LITTLE>(at),
        }
    }

    #[inline]
    fn numbers(&self, at: usize, size: u8, count: u32) -> Result<(&'a [u8], usize), RunError> {
        if count == 0 {
            return Ok((&[], at)); // No padding before an element that is not there.
        }
        self.take(self.align(at, size), u64::from(count) * u64::from(size))
    }

    fn steps<const LITTLE: bool, S: Sink>(
        &mut self,
        mut at: usize,
        steps: &[Step],
        sink: &mut S,
    ) -> Result<usize, RunError> {
        let mut next = 0;
        while let Some(step) = steps.get(next) {
            next += 1;
            match *step {
                Step::Skip { align, bytes } => at = self.skip(self.align(at, align), u64::from(bytes))?,
                Step::SkipText => {
                    let (length, text) = self.length::<LITTLE>(at)?;
                    at = self.skip(text, u64::from(length))?;
                }
                Step::SkipWideText => {
                    let (length, text) = self.length::<LITTLE>(at)?;
                    at = self.skip(text, 2 * u64::from(length))?;
                }
                Step::SkipNumbers { number, sequences } => {
                    let size = number.size();
                    for _ in 0..sequences {
                        let (count, first) = self.length::<LITTLE>(at)?;
                        at = self.numbers(first, size, count)?.1;
                    }
                }
                Step::Number { slot, number } => {
                    let (piece, end) = self.numbers(at, number.size(), 1)?;
                    self.cache.note(Found::Number(slot, number, end - piece.len(), end));
                    sink.number(slot, number_from(number, LITTLE, piece));
                    at = end;
                }
                Step::Text(slot) => {
                    let (length, text) = self.length::<LITTLE>(at)?;
                    let (text, end) = self.take(text, u64::from(length))?;
                    self.cache.note(Found::Text(slot, end - text.len(), end));
                    sink.text(slot, without_terminator(text));
                    at = end;
                }
                Step::Numbers { slot, number, count } => {
                    let (count, first) = self.count::<LITTLE>(at, count)?;
                    let (bytes, end) = self.numbers(first, number.size(), count)?;
                    self.cache.note(Found::Numbers(slot, number, end - bytes.len(), end));
                    sink.numbers(slot, Numbers::Wire { number, little_endian: LITTLE, bytes });
                    at = end;
                }
                Step::Texts { slot, count } => at = self.texts::<LITTLE, S>(at, slot, count, sink)?,
                Step::Repeat { slot, count, steps: inner, least } => {
                    let end = next + inner as usize;
                    let inner = &steps[next..end.min(steps.len())];
                    at = self.repeat::<LITTLE, S>(at, (slot, count, least), inner, sink)?;
                    next = end;
                }
                Step::StructStart => at = self.length::<LITTLE>(at)?.1,
            }
        }
        Ok(at)
    }

    fn texts<const LITTLE: bool, S: Sink>(
        &mut self,
        at: usize,
        slot: Slot,
        fixed: Option<u32>,
        sink: &mut S,
    ) -> Result<usize, RunError> {
        let (list_end, at) = self.list_end::<LITTLE>(at)?;
        let start = self.align(at, 4);
        if fixed.is_none()
            && let Some(expected) = sink.expected_texts(slot)
            && self.body.get(start..).is_some_and(|rest| rest.starts_with(expected))
        {
            let end = start + expected.len();
            self.cache.note(Found::Texts(slot, start, end));
            sink.same_texts(slot);
            return Self::check_end(end, list_end);
        }
        let (count, mut at) = self.count::<LITTLE>(start, fixed)?;
        for _ in 0..count {
            let (length, text) = self.length::<LITTLE>(at)?;
            at = self.skip(text, u64::from(length))?;
        }
        if fixed.is_none() {
            self.cache.note(Found::Texts(slot, start, at));
            let raw = &self.body[start..at];
            sink.texts(
                slot,
                Texts::Wire { little_endian: LITTLE, padded: self.widest > 1, count: count as usize, raw },
            );
        }
        Self::check_end(at, list_end)
    }

    #[inline]
    fn repeat<const LITTLE: bool, S: Sink>(
        &mut self,
        at: usize,
        (slot, fixed, least): (Option<Slot>, Option<u32>, u64),
        steps: &[Step],
        sink: &mut S,
    ) -> Result<usize, RunError> {
        let (list_end, at) = self.list_end::<LITTLE>(at)?;
        let (count, mut at) = self.count::<LITTLE>(at, fixed)?;
        // Checked before walking: a count cannot ask for more elements than bytes can hold.
        let needed = u64::from(count).saturating_mul(least);
        if needed > self.body.len().saturating_sub(at) as u64 {
            return Err(RunError::Short { at, needed, end: self.body.len() });
        }
        for _ in 0..count {
            if let Some(slot) = slot {
                self.cache.note(Found::Element(slot));
                sink.element(slot);
            }
            at = self.steps::<LITTLE, S>(at, steps, sink)?;
        }
        Self::check_end(at, list_end)
    }

    /// Where a list ends, if its size precedes it, and where it starts.
    #[inline]
    fn list_end<const LITTLE: bool>(&mut self, at: usize) -> Result<(Option<usize>, usize), RunError> {
        if !self.sizes.of_lists {
            return Ok((None, at));
        }
        let (size, at) = self.length::<LITTLE>(at)?;
        Ok((Some(at.saturating_add(size as usize)), at))
    }

    #[inline]
    fn check_end(at: usize, list_end: Option<usize>) -> Result<usize, RunError> {
        match list_end {
            Some(end) if end != at => Err(RunError::ListSize { at, end }),
            _ => Ok(at),
        }
    }
}
