//! Messages of one layout agree in their lengths and names: these are compared by words.

use std::ops::Range;

/// The bytes in which messages that are laid out alike agree.
#[derive(Debug, Clone, Default, PartialEq)]
pub(in crate::log) struct Template {
    bytes: usize,
    words: Vec<Word>,
}

/// Eight bytes at a place, and the bits of them that count.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Word {
    at: usize,
    value: u64,
    mask: u64,
}

impl Template {
    /// The message itself in these spans, and anything elsewhere; `None` if it is shorter than a word.
    pub(in crate::log) fn of(message: &[u8], fixed: impl Iterator<Item = Range<usize>>) -> Option<Self> {
        let last = message.len().checked_sub(size_of::<u64>())?;
        let mut counts = vec![false; message.len()];
        for span in fixed {
            counts.get_mut(span)?.fill(true);
        }
        let mut words: Vec<Word> = Vec::new();
        for (place, _) in counts.iter().enumerate().filter(|(_, counts)| **counts) {
            if words.last().is_none_or(|word| place - word.at >= size_of::<u64>()) {
                let at = place.min(last);
                words.push(Word { at, value: word(message, at)?, mask: 0 });
            }
            if let Some(word) = words.last_mut() {
                word.mask |= 0xff << (8 * (place - word.at));
            }
        }
        for word in &mut words {
            word.value &= word.mask;
        }
        Some(Self { bytes: message.len(), words })
    }

    /// Whether a message is as long and agrees in every fixed byte. A loop of its own: within a larger function it
    /// runs out of registers.
    #[inline(never)]
    pub(in crate::log) fn fits(&self, message: &[u8]) -> bool {
        if message.len() != self.bytes {
            return false;
        }
        // All words without a branch on what they hold: nearly every message fits.
        let mut odd = 0;
        for own in &self.words {
            let Some(found) = word(message, own.at) else { return false };
            odd |= (found & own.mask) ^ own.value;
        }
        odd == 0
    }
}

#[inline]
fn word(message: &[u8], at: usize) -> Option<u64> {
    Some(u64::from_le_bytes(*message.get(at..)?.first_chunk()?))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn a_message_fits_if_it_differs_in_no_fixed_byte(
            message in prop::collection::vec(any::<u8>(), 8..60),
            spans in prop::collection::vec((0..60_usize, 0..20_usize), 0..6),
            changed in 0..60_usize,
        ) {
            let end = message.len();
            let spans: Vec<_> = spans.iter().map(|(at, bytes)| *at.min(&end)..(at + bytes).min(end)).collect();
            let template = Template::of(&message, spans.iter().cloned()).unwrap();
            prop_assert!(template.fits(&message));
            prop_assert!(!template.fits(&message[1..]));
            let mut other = message.clone();
            let changed = changed % end;
            other[changed] ^= 0x40;
            prop_assert_eq!(template.fits(&other), !spans.iter().any(|span| span.contains(&changed)));
        }
    }

    #[test]
    fn what_is_shorter_than_a_word_or_than_its_spans_has_no_template() {
        assert_eq!(Template::of(&[0; 7], std::iter::empty()), None);
        assert_eq!(Template::of(&[0; 9], std::iter::once(8..12)), None);
    }
}
