//! When messages were sampled, published and received.

use super::{lists::Rows, make_room};
use crate::{log::options::TimeBase, math::median};

/// The three clocks of every message of a topic, in the order of the file.
#[derive(Debug, Clone, Default, PartialEq)]
#[expect(clippy::struct_field_names, reason = "units are in names")]
pub(in crate::log) struct Stamps {
    /// From the message itself; 0 where it has none.
    pub(in crate::log) header_ns: Vec<i64>,
    /// Empty as long as each is that of the recorder, as most recorders have it.
    publish_ns: Vec<i64>,
    pub(in crate::log) log_ns: Vec<i64>,
}

impl Stamps {
    /// The readings of one clock.
    pub(in crate::log) fn of(&self, base: TimeBase) -> &[i64] {
        match base {
            TimeBase::Header => &self.header_ns,
            TimeBase::Publish if !self.publish_ns.is_empty() => &self.publish_ns,
            TimeBase::Publish | TimeBase::Log => &self.log_ns,
        }
    }

    /// Whether a clock is set and runs: most readings differ from the one before.
    pub(in crate::log) fn runs(&self, base: TimeBase) -> bool {
        let stamp_ns = self.of(base);
        let set = stamp_ns.iter().filter(|&&ns| ns != 0).count();
        let steps = stamp_ns.windows(2).filter(|w| w[0] != w[1]).count();
        2 * set > stamp_ns.len() && 2 * steps >= stamp_ns.len().saturating_sub(1)
    }

    /// Least, median and largest delay from header stamp to recorder, ns.
    #[expect(clippy::cast_possible_truncation, reason = "delays of a recording")]
    pub(in crate::log) fn delays_ns(&self) -> Option<[i64; 3]> {
        let both = self.log_ns.iter().zip(&self.header_ns).filter(|(_, header)| **header != 0);
        let delays = both.map(|(log, header)| log.saturating_sub(*header));
        let ends = [delays.clone().min()?, delays.clone().max()?];
        let middle = median(delays.map(|ns| ns as f64).collect()) as i64;
        Some([ends[0], middle, ends[1]])
    }

    pub(in crate::log) fn len(&self) -> usize {
        self.log_ns.len()
    }

    pub(in crate::log::source) fn push_ns(&mut self, header_ns: i64, publish_ns: i64, log_ns: i64) {
        self.header_ns.push(header_ns);
        if publish_ns != log_ns || !self.publish_ns.is_empty() {
            self.tell_apart();
            self.publish_ns.push(publish_ns);
        }
        self.log_ns.push(log_ns);
    }

    pub(in crate::log::source) fn push(&mut self, header_ns: i64, publish_ns: u64, log_ns: u64) {
        let fit = |ns| i64::try_from(ns).unwrap_or(i64::MAX);
        self.push_ns(header_ns, fit(publish_ns), fit(log_ns));
    }

    pub(in crate::log::source) fn append(&mut self, other: &Self, expected: usize) {
        make_room(&mut self.header_ns, expected);
        make_room(&mut self.log_ns, expected);
        self.header_ns.extend_from_slice(&other.header_ns);
        if !(self.publish_ns.is_empty() && other.publish_ns.is_empty()) {
            self.tell_apart();
            self.publish_ns.extend_from_slice(other.of(TimeBase::Publish));
        }
        self.log_ns.extend_from_slice(&other.log_ns);
    }

    /// Those of some of the rows.
    pub(super) fn of_rows(&self, rows: &Rows) -> Self {
        let Self { header_ns, publish_ns, log_ns } = self;
        Self { header_ns: rows.of(header_ns), publish_ns: rows.of(publish_ns), log_ns: rows.of(log_ns) }
    }

    /// From here on publish times have a place of their own.
    fn tell_apart(&mut self) {
        if self.publish_ns.is_empty() {
            self.publish_ns.clone_from(&self.log_ns);
        }
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
