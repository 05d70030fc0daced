//! Breaks inputs: bits, numbers, pieces moved, doubled and lost, words of the format in wrong places.

/// `SplitMix64`.
pub struct Dice(pub u64);

impl Dice {
    /// A number.
    pub fn roll(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// A number below a bound; 0 below none.
    pub fn below(&mut self, bound: usize) -> usize {
        (self.roll() % bound.max(1) as u64) as usize
    }
}

/// Numbers that lengths, counts and stamps do not expect.
const ODD: [u64; 12] =
    [0, 1, 7, 8, 255, 1 << 15, 1 << 31, (1 << 32) - 1, 1 << 40, 1 << 63, u64::MAX - 8, u64::MAX];

/// Texts that parsers of numbers, tables and trees do not expect.
const WORDS: [&str; 24] = [
    "nan",
    "-inf",
    "1e999",
    "-0.0",
    "99999999999999999999",
    "0x10",
    "1,5",
    "\"",
    "'''",
    "[[",
    "]",
    "{",
    "}",
    "=",
    "\n",
    "\0",
    "\u{202e}",
    "é",
    "<",
    "/>",
    "<!--",
    "&amp;",
    "[joint.x]\n",
    ";;;;",
];

/// Breaks an input in one to six places.
pub fn mutate(bytes: &mut Vec<u8>, other: &[u8], dice: &mut Dice) {
    for _ in 0..=dice.below(6) {
        let length = bytes.len();
        let at = dice.below(length);
        let span = at..(at + 1 + dice.below(40)).min(length);
        match dice.below(14) {
            0 | 1 => {
                if let Some(byte) = bytes.get_mut(at) {
                    *byte ^= 1 << dice.below(8);
                }
            }
            2 => bytes[span].fill_with(|| dice.roll() as u8),
            3 | 4 => {
                let odd = ODD[dice.below(ODD.len())].to_le_bytes();
                let width = [2, 4, 8][dice.below(3)];
                bytes[at..].iter_mut().zip(&odd[..width]).for_each(|(byte, odd)| *byte = *odd);
            }
            5 | 6 => drop(bytes.drain(span)),
            7 => {
                let copy = bytes[span].to_vec();
                let to = dice.below(length);
                bytes.splice(to..to, copy);
            }
            8 => drop(bytes.splice(span, WORDS[dice.below(WORDS.len())].bytes())),
            9 => drop(bytes.splice(at..at, WORDS[dice.below(WORDS.len())].bytes())),
            10 => {
                let end = (at + dice.below(4096)).min(length);
                bytes[at..end].fill(0);
            }
            11 if !other.is_empty() => {
                let from = dice.below(other.len());
                let end = (from + dice.below(400)).min(other.len());
                bytes.splice(span, other[from..end].iter().copied());
            }
            12 => {
                // A line twice, or out of its place.
                let line = |from: usize| from + bytes[from..].iter().position(|b| *b == b'\n').unwrap_or(0);
                let (start, to) = (line(at), line(dice.below(length)));
                let copy = bytes[start..(line((start + 1).min(length))).max(start)].to_vec();
                bytes.splice(to..to, copy);
            }
            _ => bytes.truncate(length - dice.below(length / 4 + 1)),
        }
        if bytes.is_empty() {
            return;
        }
    }
}
