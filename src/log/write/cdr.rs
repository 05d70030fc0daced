//! Little-endian CDR as ROS 2 messages use it (OMG DDSI-RTPS 2.3, 10.5: `CDR_LE`).

/// Encapsulation header: representation 1 is little-endian plain CDR, no options.
const ENCAPSULATION: [u8; 4] = [0, 1, 0, 0];

/// Serialises one message after another into a buffer that it keeps.
///
/// Values align to their own size, counted from behind the encapsulation header.
#[derive(Debug, Default)]
pub(super) struct Cdr {
    bytes: Vec<u8>,
}

impl Cdr {
    /// Forgets the last message and starts the next.
    pub(super) fn begin(&mut self) {
        self.bytes.clear();
        self.bytes.extend_from_slice(&ENCAPSULATION);
    }

    /// The message, encapsulation header included.
    pub(super) fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    pub(super) fn i32(&mut self, value: i32) {
        self.align(4);
        self.bytes.extend_from_slice(&value.to_le_bytes());
    }

    pub(super) fn u32(&mut self, value: u32) {
        self.align(4);
        self.bytes.extend_from_slice(&value.to_le_bytes());
    }

    pub(super) fn f64(&mut self, value: f64) {
        self.align(8);
        self.bytes.extend_from_slice(&value.to_le_bytes());
    }

    /// The number of elements that follow. More than `u32::MAX` elements do not fit a message.
    pub(super) fn count(&mut self, elements: usize) {
        self.u32(u32::try_from(elements).unwrap_or(u32::MAX));
    }

    /// The length counts the closing NUL; `text` has none inside.
    pub(super) fn string(&mut self, text: &str) {
        self.count(text.len() + 1);
        self.bytes.extend_from_slice(text.as_bytes());
        self.bytes.push(0);
    }

    pub(super) fn strings(&mut self, texts: &[String]) {
        self.count(texts.len());
        for text in texts {
            self.string(text);
        }
    }

    /// An empty sequence is its count alone, without padding up to the first element.
    pub(super) fn f64_sequence(&mut self, values: impl ExactSizeIterator<Item = f64>) {
        self.count(values.len());
        for value in values {
            self.f64(value);
        }
    }

    fn align(&mut self, size: usize) {
        let body = self.bytes.len().saturating_sub(ENCAPSULATION.len());
        self.bytes.resize(ENCAPSULATION.len() + body.next_multiple_of(size), 0);
    }
}
