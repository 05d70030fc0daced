//! An encoder of CDR, in all forms that recorders write.

/// How a message is encoded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    LittleEndian,
    BigEndian,
    /// XCDR2 with a size before each list of structs or texts.
    Xcdr2,
    /// The same without these sizes, as some writers have it.
    Xcdr2NoSizes,
    /// XCDR2 with a size before structs as well.
    Delimited,
}

pub(crate) const KINDS: [Kind; 5] =
    [Kind::LittleEndian, Kind::BigEndian, Kind::Xcdr2, Kind::Xcdr2NoSizes, Kind::Delimited];

/// A message in the making.
pub(crate) struct Cdr {
    kind: Kind,
    body: Vec<u8>,
}

impl Cdr {
    /// The bytes of a message whose root struct `write` fills.
    pub(crate) fn message(kind: Kind, write: impl FnOnce(&mut Self)) -> Vec<u8> {
        let mut cdr = Self { kind, body: Vec::new() };
        cdr.record(write);
        let id = match kind {
            Kind::LittleEndian => 1,
            Kind::BigEndian => 0,
            Kind::Xcdr2 | Kind::Xcdr2NoSizes => 7,
            Kind::Delimited => 9,
        };
        let mut bytes = vec![0, id, 0, 0];
        bytes.append(&mut cdr.body);
        bytes
    }

    fn put<const N: usize>(&mut self, mut little_endian: [u8; N]) {
        let widest = if matches!(self.kind, Kind::LittleEndian | Kind::BigEndian) { 8 } else { 4 };
        while !self.body.len().is_multiple_of(N.min(widest)) {
            self.body.push(0);
        }
        if self.kind == Kind::BigEndian {
            little_endian.reverse();
        }
        self.body.extend(little_endian);
    }

    pub(crate) fn u8(&mut self, value: u8) {
        self.put([value]);
    }

    pub(crate) fn u16(&mut self, value: u16) {
        self.put(value.to_le_bytes());
    }

    pub(crate) fn u32(&mut self, value: u32) {
        self.put(value.to_le_bytes());
    }

    pub(crate) fn u64(&mut self, value: u64) {
        self.put(value.to_le_bytes());
    }

    pub(crate) fn i32(&mut self, value: i32) {
        self.put(value.to_le_bytes());
    }

    pub(crate) fn f32(&mut self, value: f32) {
        self.put(value.to_le_bytes());
    }

    pub(crate) fn f64(&mut self, value: f64) {
        self.put(value.to_le_bytes());
    }

    pub(crate) fn text(&mut self, text: &str) {
        self.u32(text.len() as u32 + 1);
        self.body.extend(text.bytes());
        self.body.push(0);
    }

    pub(crate) fn f64s(&mut self, values: &[f64]) {
        self.u32(values.len() as u32);
        values.iter().for_each(|&value| self.f64(value));
    }

    pub(crate) fn record(&mut self, write: impl FnOnce(&mut Self)) {
        let sized = self.kind == Kind::Delimited;
        self.sized(sized, write);
    }

    /// A sequence whose elements are structs or texts.
    pub(crate) fn list<T>(&mut self, items: &[T], mut write: impl FnMut(&mut Self, &T)) {
        let sized = matches!(self.kind, Kind::Xcdr2 | Kind::Delimited);
        self.sized(sized, |cdr| {
            cdr.u32(items.len() as u32);
            items.iter().for_each(|item| write(cdr, item));
        });
    }

    /// Elements of a fixed array of structs or texts.
    pub(crate) fn array<T>(&mut self, items: &[T], mut write: impl FnMut(&mut Self, &T)) {
        let sized = matches!(self.kind, Kind::Xcdr2 | Kind::Delimited);
        self.sized(sized, |cdr| items.iter().for_each(|item| write(cdr, item)));
    }

    fn sized(&mut self, sized: bool, write: impl FnOnce(&mut Self)) {
        if !sized {
            return write(self);
        }
        self.u32(0);
        let start = self.body.len();
        write(self);
        let size = (self.body.len() - start) as u32;
        self.body[start - 4..start].copy_from_slice(&size.to_le_bytes());
    }

    pub(crate) fn texts(&mut self, texts: &[&str]) {
        self.list(texts, |cdr, text| cdr.text(text));
    }

    /// `builtin_interfaces/Time` or `Duration`.
    pub(crate) fn time(&mut self, ns: i64) {
        self.record(|cdr| {
            cdr.i32(ns.div_euclid(1_000_000_000) as i32);
            cdr.u32(ns.rem_euclid(1_000_000_000) as u32);
        });
    }

    /// `std_msgs/Header`.
    pub(crate) fn header(&mut self, ns: i64) {
        self.record(|cdr| {
            cdr.time(ns);
            cdr.text("base");
        });
    }
}
