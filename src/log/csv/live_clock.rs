//! The clock of rows that come one by one.

use super::{
    read::{LATE, REPEATED},
    time::{TimeSource, Wraps},
};
use crate::remark::{Code, Remarks};

/// So many rows in turn that are behind the latest say that the clock was set back.
const SET_BACK: u32 = 8;

/// Where the clock is, ns, and how often it did what clocks do not.
#[derive(Debug, Clone)]
pub(super) struct LiveClock {
    /// Midnights that times of a day went past, and the last of these times.
    day_ns: i64,
    before_ns: i64,
    /// Stamp of the last row, latest instant of receipt, what the clock was set back by, and the last step.
    last_ns: i64,
    latest_ns: i64,
    shift_ns: i64,
    step_ns: i64,
    /// Rows behind in turn, and the stamp of the first of them.
    behind: u32,
    first_behind_ns: i64,
    repeated: u64,
    late: u64,
    set_back: u64,
    wraps: Wraps,
}

impl Default for LiveClock {
    fn default() -> Self {
        Self {
            day_ns: 0,
            before_ns: i64::MIN,
            last_ns: i64::MIN,
            latest_ns: i64::MIN,
            shift_ns: 0,
            step_ns: 0,
            behind: 0,
            first_behind_ns: 0,
            repeated: 0,
            late: 0,
            set_back: 0,
            wraps: Wraps::default(),
        }
    }
}

impl LiveClock {
    /// What it counts.
    pub(super) const SAYS: [Code; 3] = [Code::DuplicateStamp, Code::Reordered, Code::ClockJump];

    /// The same at the same time of the same day, with nothing counted.
    pub(super) fn going_on(&self) -> Self {
        Self {
            day_ns: self.day_ns,
            before_ns: self.before_ns,
            wraps: self.wraps.going_on(),
            ..Self::default()
        }
    }

    /// The stamp on the clock of the log: times of a day go on after midnight, others count from a fixed instant.
    pub(super) fn settled(&mut self, source: &TimeSource, ns: i64, absolute: bool) -> i64 {
        let mut one = [self.wraps.undone(source, ns)];
        if source.is_of_day() {
            self.day_ns += TimeSource::DAY_NS * i64::from(source.next_day(self.before_ns, ns));
            self.before_ns = ns;
            one = [ns.saturating_add(self.day_ns)];
        }
        source.count_from(absolute, &mut one);
        one[0]
    }

    /// When a row counts as received: never before the row before it, and on where the clock was set back.
    pub(super) fn received(&mut self, ns: i64) -> i64 {
        self.repeated += u64::from(ns == self.last_ns);
        self.last_ns = ns;
        let at_ns = ns.saturating_add(self.shift_ns);
        if at_ns >= self.latest_ns {
            if self.latest_ns > i64::MIN {
                self.step_ns = at_ns - self.latest_ns;
            }
            (self.behind, self.latest_ns) = (0, at_ns);
        } else {
            if self.behind == 0 {
                self.first_behind_ns = ns;
            }
            self.behind += 1;
            self.late += 1;
            if self.behind == SET_BACK {
                // As if that had been known of the first of them.
                let back_ns = self.latest_ns.saturating_sub(self.first_behind_ns);
                self.shift_ns = back_ns.saturating_add(self.step_ns);
                self.latest_ns = self.latest_ns.max(ns.saturating_add(self.shift_ns));
                self.late -= u64::from(SET_BACK);
                self.set_back += 1;
                self.behind = 0;
            }
        }
        self.latest_ns
    }

    /// Says what it counted.
    pub(super) fn remark(&self, remarks: &mut Remarks) {
        remarks.add(Code::DuplicateStamp, self.repeated, REPEATED);
        remarks.add(Code::Reordered, self.late, LATE);
        let message = "places where the clock goes back; a report splits the run there";
        remarks.add(Code::ClockJump, self.set_back, message);
        self.wraps.remark(remarks);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::series::continuous_clock;

    #[test]
    fn no_row_is_lost_where_the_clock_is_set_back() {
        let due_ns = |k: i64| 20_000_000 * (1 + k);
        let mut clock = LiveClock::default();
        let stamp_ns: Vec<i64> =
            (0..200).map(|k| due_ns(k) + if k < 150 { 0 } else { -2_000_000_000 }).collect();
        let received_ns: Vec<i64> = stamp_ns.iter().map(|ns| clock.received(*ns)).collect();
        let found = continuous_clock(&stamp_ns, &received_ns, &[]);
        assert_eq!((found.misfits, found.cuts), (0, vec![150]));
        assert_eq!(found.t_ns, (0..200).map(due_ns).collect::<Vec<_>>());
    }
}
