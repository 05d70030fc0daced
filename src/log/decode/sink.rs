//! Where decoded fields go.

use crate::log::schema::Number;

/// Which wanted field a value belongs to; the asker numbers them.
pub(in crate::log) type Slot = u8;

/// Receives the wanted fields of one message in the order in which they lie in it; what it has no use for it need not take.
pub(in crate::log) trait Sink {
    /// A single number.
    fn number(&mut self, slot: Slot, value: f64);
    /// A single text, without its terminator.
    fn text(&mut self, _slot: Slot, _text: &[u8]) {}
    /// A list of numbers.
    fn numbers(&mut self, _slot: Slot, _values: Numbers<'_>) {}
    /// A list of texts.
    fn texts(&mut self, _slot: Slot, _values: Texts<'_>) {}
    /// An element of a wanted list of structs starts; its fields follow.
    fn element(&mut self, _slot: Slot) {}
    /// The bytes of the list of texts last seen in this slot, if the sink can tell a repetition
    /// from them; it is then told by [`Sink::same_texts`] and the list is not walked.
    fn expected_texts(&self, _slot: Slot) -> Option<&[u8]> {
        None
    }
    /// The list of texts is the one that was expected.
    fn same_texts(&mut self, _slot: Slot) {}
}

/// A list of numbers as it lies in the message.
#[derive(Debug, Clone, Copy)]
pub(in crate::log) enum Numbers<'a> {
    /// Bytes of equal-sized numbers.
    Wire { number: Number, little_endian: bool, bytes: &'a [u8] },
    /// Numbers that were parsed from text; missing ones are NaN.
    Parsed(&'a [f64]),
}

impl Numbers<'_> {
    pub(in crate::log) fn len(self) -> usize {
        match self {
            Self::Wire { number, bytes, .. } => bytes.len() / usize::from(number.size()),
            Self::Parsed(values) => values.len(),
        }
    }

    /// Hands over each number in turn.
    #[inline]
    pub(in crate::log) fn for_each(self, mut each: impl FnMut(f64)) {
        match self {
            // The one case that matters for speed: float64 of a little-endian machine.
            Self::Wire { number: Number::F64, little_endian: true, bytes } => {
                for eight in bytes.as_chunks::<8>().0 {
                    each(f64::from_le_bytes(*eight));
                }
            }
            Self::Wire { number, little_endian, bytes } => {
                for piece in bytes.chunks_exact(usize::from(number.size())) {
                    each(number_from(number, little_endian, piece));
                }
            }
            Self::Parsed(values) => values.iter().copied().for_each(each),
        }
    }

    pub(in crate::log) fn to_vec(self) -> Vec<f64> {
        let mut values = Vec::with_capacity(self.len());
        self.for_each(|value| values.push(value));
        values
    }
}

/// A list of texts as it lies in the message.
#[derive(Debug, Clone, Copy)]
pub(in crate::log) enum Texts<'a> {
    /// `raw`: the count and everything up to the end of the last text, starting at a multiple
    /// of four bytes, unless nothing is padded. Lengths have been checked.
    Wire { little_endian: bool, padded: bool, count: usize, raw: &'a [u8] },
    /// Texts that were parsed from text.
    Parsed(&'a [String]),
}

impl Texts<'_> {
    pub(in crate::log) fn to_vec(self) -> Vec<String> {
        match self {
            Self::Parsed(texts) => texts.to_vec(),
            Self::Wire { little_endian, padded, count, raw } => {
                let mut at = 4;
                let mut texts = Vec::with_capacity(count);
                for _ in 0..count {
                    at = if padded { (at + 3) & !3 } else { at };
                    let Some(length) = raw.get(at..at + 4).and_then(|b| b.first_chunk::<4>()) else { break };
                    let length =
                        if little_endian { u32::from_le_bytes(*length) } else { u32::from_be_bytes(*length) }
                            as usize;
                    let Some(text) = raw.get(at + 4..at + 4 + length) else { break };
                    texts.push(String::from_utf8_lossy(without_terminator(text)).into_owned());
                    at += 4 + length;
                }
                texts
            }
        }
    }
}

/// CDR counts the terminating NUL in a text's length.
pub(super) fn without_terminator(text: &[u8]) -> &[u8] {
    text.strip_suffix(&[0]).unwrap_or(text)
}

/// One number of the wire; `piece` is exactly its size.
#[expect(clippy::cast_precision_loss, reason = "64-bit integers are read as f64 by contract")]
#[inline]
pub(in crate::log) fn number_from(number: Number, little_endian: bool, piece: &[u8]) -> f64 {
    let mut bytes = [0; 8];
    let size = piece.len().min(8);
    // Little-endian form in the low bytes, whatever came in.
    bytes[..size].copy_from_slice(&piece[..size]);
    if !little_endian {
        bytes[..size].reverse();
    }
    let [b0, b1, b2, b3, ..] = bytes;
    match number {
        Number::Bool | Number::U8 => f64::from(b0),
        Number::I8 => f64::from(b0.cast_signed()),
        Number::I16 => f64::from(i16::from_le_bytes([b0, b1])),
        Number::U16 => f64::from(u16::from_le_bytes([b0, b1])),
        Number::I32 => f64::from(i32::from_le_bytes([b0, b1, b2, b3])),
        Number::U32 => f64::from(u32::from_le_bytes([b0, b1, b2, b3])),
        Number::F32 => f64::from(f32::from_le_bytes([b0, b1, b2, b3])),
        Number::I64 => i64::from_le_bytes(bytes) as f64,
        Number::U64 => u64::from_le_bytes(bytes) as f64,
        Number::F64 => f64::from_le_bytes(bytes),
    }
}
