//! When messages were sampled, published and received.

/// The three clocks of every message of a topic, in the order of the file.
#[derive(Debug, Clone, Default, PartialEq)]
#[expect(clippy::struct_field_names, reason = "units are in names")]
pub(in crate::log) struct Stamps {
    /// From the message itself; 0 where it has none.
    pub(in crate::log) header_ns: Vec<i64>,
    pub(in crate::log) publish_ns: Vec<i64>,
    pub(in crate::log) log_ns: Vec<i64>,
}

impl Stamps {
    pub(in crate::log) fn len(&self) -> usize {
        self.log_ns.len()
    }

    pub(in crate::log::source) fn push_ns(&mut self, header_ns: i64, publish_ns: i64, log_ns: i64) {
        self.header_ns.push(header_ns);
        self.publish_ns.push(publish_ns);
        self.log_ns.push(log_ns);
    }

    pub(in crate::log::source) fn push(&mut self, header_ns: i64, publish_ns: u64, log_ns: u64) {
        let fit = |ns| i64::try_from(ns).unwrap_or(i64::MAX);
        self.push_ns(header_ns, fit(publish_ns), fit(log_ns));
    }

    pub(in crate::log::source) fn append(&mut self, other: &Self) {
        self.header_ns.extend_from_slice(&other.header_ns);
        self.publish_ns.extend_from_slice(&other.publish_ns);
        self.log_ns.extend_from_slice(&other.log_ns);
    }

    pub(in crate::log::source) fn clear(&mut self) {
        self.header_ns.clear();
        self.publish_ns.clear();
        self.log_ns.clear();
    }
}

/// Seconds and nanoseconds of a stamp in nanoseconds, 0 if it is no time.
#[expect(clippy::cast_possible_truncation, reason = "range checked")]
pub(in crate::log::source) fn stamp_ns(second: f64, nanosecond: f64) -> i64 {
    let fits = |value: f64| value.is_finite() && value.abs() < 9.0e9;
    if fits(second) && fits(nanosecond) { second as i64 * 1_000_000_000 + nanosecond as i64 } else { 0 }
}
