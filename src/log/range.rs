//! A stretch of a run, by the time that its reports show.

use crate::{
    series::{Series, Track},
    units::{NS_PER_S, nanoseconds},
};

/// A stretch of a run, counted from the run's first sample; both ends belong to it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TimeRange {
    from_ns: i64,
    to_ns: i64,
}

/// All of it.
impl Default for TimeRange {
    fn default() -> Self {
        Self { from_ns: i64::MIN, to_ns: i64::MAX }
    }
}

impl TimeRange {
    /// From one second to another; where one is `None`, without that end.
    pub fn of_seconds(from_s: Option<f64>, to_s: Option<f64>) -> Self {
        let whole = Self::default();
        Self {
            from_ns: from_s.map_or(whole.from_ns, nanoseconds),
            to_ns: to_s.map_or(whole.to_ns, nanoseconds),
        }
    }

    /// Whether it has an end.
    pub fn cuts(self) -> bool {
        self != Self::default()
    }

    /// Whether an instant belongs to it.
    pub(super) fn holds(self, epoch_ns: i64, at_ns: i64) -> bool {
        self.begins_by(epoch_ns, at_ns) && at_ns.saturating_sub(epoch_ns) <= self.to_ns
    }

    /// Whether it begins at an instant or before.
    pub(super) fn begins_by(self, epoch_ns: i64, at_ns: i64) -> bool {
        at_ns.saturating_sub(epoch_ns) >= self.from_ns
    }

    /// The same with a margin at both ends.
    pub(super) fn widened(self, by_ns: i64) -> Self {
        let by_ns = by_ns.saturating_abs();
        Self { from_ns: self.from_ns.saturating_sub(by_ns), to_ns: self.to_ns.saturating_add(by_ns) }
    }

    /// Leaves of tracks what lies in it, by their times from the run's first sample.
    pub(super) fn cut(self, series: &mut Series) {
        let within = |track: &Track| {
            let ends = [self.from_ns, self.to_ns.saturating_add(1)];
            let [from, to] = ends.map(|at_ns| track.t_s().partition_point(|t_s| nanoseconds(*t_s) < at_ns));
            from..to
        };
        if series.tracks.iter().any(|track| within(track).len() < track.len()) {
            series.tracks = series.tracks.iter().filter_map(|track| track.part(within(track))).collect();
        }
    }

    /// The first and the last instant that samples of it may have on a clock that is off by `margin_ns` at most,
    /// for a run that begins between two instants of that clock.
    pub(super) fn around(self, begins_ns: [i64; 2], margin_ns: i64) -> [i64; 2] {
        [
            begins_ns[0].saturating_add(self.from_ns).saturating_sub(margin_ns),
            begins_ns[1].saturating_add(self.to_ns).saturating_add(margin_ns),
        ]
    }

    /// In words.
    pub(super) fn words(self) -> String {
        let seconds = |ns: i64| ns as f64 / NS_PER_S;
        let Self { from_ns, to_ns } = self;
        match (from_ns == i64::MIN, to_ns == i64::MAX) {
            (_, true) => format!("from {:.2} s on", seconds(from_ns)),
            (true, false) => format!("up to {:.2} s", seconds(to_ns)),
            (false, false) => format!("from {:.2} to {:.2} s", seconds(from_ns), seconds(to_ns)),
        }
    }
}
