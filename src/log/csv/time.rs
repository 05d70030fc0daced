//! How each row gets its stamp.

use super::{
    date::{DateForm, Part},
    number::{self, nanoseconds, nanoseconds_after},
    spread::{complete, spread},
    unit::{Measure, Unit},
};
use crate::{
    remark::{Code, Remarks},
    units::{NS_PER_S, whole_ns},
};

/// The instant that times without a date count from, ns since 1970: 2025-10-09 08:53:20 UTC. No wall clock,
/// so that equal files give equal logs and files with one zero of time fit together.
pub const UNDATED_NS: i64 = 1_760_000_000_000_000_000;

/// Whether a log that begins at an instant, ns since 1970, says when it was recorded: stamps before 1973 count from
/// something else, and those of the day after [`UNDATED_NS`] from there.
pub fn is_dated(epoch_ns: i64) -> bool {
    epoch_ns >= FIRST_ABSOLUTE_NS && !(UNDATED_NS..UNDATED_NS + TimeSource::DAY_NS).contains(&epoch_ns)
}

/// Stamps before this one, ns since 1970, count from something else.
pub(super) const FIRST_ABSOLUTE_NS: i64 = 100_000_000_000_000_000;

/// How each row gets its stamp.
#[derive(Debug, Clone)]
pub(super) enum TimeSource {
    Rate {
        hz: f64,
    },
    Number {
        column: usize,
        unit: Unit,
    },
    Date {
        column: usize,
        form: DateForm,
    },
    DayAndTime {
        day: (usize, DateForm),
        time: (usize, DateForm),
    },
    /// Whole seconds, and what is beyond them in a column of its own.
    WithPart {
        whole: Box<TimeSource>,
        part: usize,
        unit: Unit,
    },
    /// Rows with one stamp, spread evenly over the step to the next, ns.
    Spread {
        whole: Box<TimeSource>,
        rows: usize,
        step_ns: i64,
    },
}

impl TimeSource {
    /// Stamp of a row, ns; `None` if it has none.
    pub(super) fn ns<'a>(
        &self,
        row: u64,
        cell: impl Fn(usize) -> &'a [u8] + Copy,
        decimal_comma: bool,
    ) -> Option<i64> {
        match self {
            Self::Rate { hz } => whole_ns(row as f64 * NS_PER_S / hz),
            Self::Number { column, unit } => nanoseconds_after(
                unit.zero_ns(),
                with_unit(cell(*column)).0,
                decimal_comma,
                whole_ns(unit.factor)?,
            ),
            Self::WithPart { whole: seconds, part, unit } => {
                let beyond_ns = nanoseconds(cell(*part), decimal_comma, whole_ns(unit.factor)?)?;
                seconds.ns(row, cell, decimal_comma)?.checked_add(beyond_ns)
            }
            Self::Date { column, form } => form.ns(cell(*column)),
            Self::Spread { whole, .. } => whole.ns(row, cell, decimal_comma),
            Self::DayAndTime { day, time } => day.1.ns(cell(day.0))?.checked_add(time.1.ns(cell(time.0))?),
        }
    }

    /// The columns it reads.
    pub(super) fn columns(&self) -> Vec<usize> {
        match self {
            Self::Rate { .. } => Vec::new(),
            Self::Number { column, .. } | Self::Date { column, .. } => vec![*column],
            Self::DayAndTime { day, time } => vec![day.0, time.0],
            Self::Spread { whole, .. } => whole.columns(),
            Self::WithPart { whole, part, .. } => {
                let mut columns = whole.columns();
                columns.push(*part);
                columns
            }
        }
    }

    /// The form of the times, for a person.
    pub(super) fn form(&self) -> String {
        match self {
            Self::Rate { hz } => format!("none used; rows come at {hz} Hz as given"),
            Self::Number { unit, .. } => format!("counts {}", unit.name),
            Self::Date { form, .. } if form.part == Part::Local => {
                format!("{}, no zone, taken as UTC", form.name)
            }
            Self::Date { form, .. } => form.name.to_owned(),
            Self::DayAndTime { day, time } => {
                format!("{} and {}, no zone, taken as UTC", day.1.name, time.1.name)
            }
            Self::Spread { whole, rows, .. } => {
                format!("{}, {rows} rows to each, spread evenly", whole.form())
            }
            Self::WithPart { whole, unit, .. } => format!("{}, and {} beside", whole.form(), unit.name),
        }
    }

    /// Which rows have a time of their own: not those of a step that lacks rows, where nothing tells which.
    pub(super) fn placed(&self, stamp_ns: &[i64]) -> Vec<bool> {
        match self {
            Self::Spread { rows, .. } => complete(stamp_ns, *rows),
            _ => vec![true; stamp_ns.len()],
        }
    }

    /// Makes stamps increase over midnight where there is no day, and count from a fixed instant
    /// where they count from none; whether they are absolute.
    pub(super) fn settle(&self, stamp_ns: &mut [i64]) -> bool {
        let (mut days_ns, mut before_ns) = (0_i64, i64::MIN);
        for ns in &mut *stamp_ns {
            if self.next_day(before_ns, *ns) {
                days_ns = days_ns.saturating_add(Self::DAY_NS);
            }
            before_ns = *ns;
            *ns = ns.saturating_add(days_ns);
        }
        if let Self::Spread { rows, step_ns, .. } = self {
            spread(stamp_ns, *rows, *step_ns);
        }
        let absolute = stamp_ns.first().is_some_and(|first| *first >= FIRST_ABSOLUTE_NS);
        self.count_from(absolute, stamp_ns);
        absolute
    }

    pub(super) const DAY_NS: i64 = 86_400_000_000_000;

    /// Whether its times are of a day that they do not say.
    pub(super) fn is_of_day(&self) -> bool {
        let whole =
            if let Self::WithPart { whole, .. } | Self::Spread { whole, .. } = self { whole } else { self };
        matches!(whole, Self::Date { form, .. } if form.part == Part::TimeOfDay)
    }

    /// Whether a time of a day that follows another is on the next day.
    pub(super) fn next_day(&self, before_ns: i64, ns: i64) -> bool {
        self.is_of_day() && before_ns.saturating_sub(ns) > Self::DAY_NS / 2
    }

    /// Lets stamps that say no date count from a fixed instant.
    #[expect(clippy::unused_self, reason = "the rule of this clock")]
    pub(super) fn count_from(&self, absolute: bool, stamp_ns: &mut [i64]) {
        let start_ns = if absolute { 0 } else { UNDATED_NS };
        for ns in stamp_ns {
            *ns = ns.saturating_add(start_ns);
        }
    }
}

/// Where a counter of 16 or 32 bits, or of minutes without hours, begins again: the time goes on there.
#[derive(Debug, Clone)]
pub(super) struct Wraps {
    before_ns: i64,
    /// The last two; a stamp that lies makes one of them large.
    steps_ns: [i64; 2],
    added_ns: i64,
    count: u64,
}

impl Default for Wraps {
    fn default() -> Self {
        Self { before_ns: i64::MIN, steps_ns: [0; 2], added_ns: 0, count: 0 }
    }
}

impl Wraps {
    /// After a wrap the time may go on by so many of the steps before: rows may be missing.
    const STEPS: i64 = 3;

    /// The time of a stamp, as if the counter had more bits.
    pub(super) fn undone(&mut self, source: &TimeSource, ns: i64) -> i64 {
        let Some((unit_ns, spans)) = Self::spans_ns(source) else { return ns };
        let before_ns = std::mem::replace(&mut self.before_ns, ns);
        if ns > before_ns {
            self.steps_ns = [ns.saturating_sub(before_ns), self.steps_ns[0]];
        } else if ns >= 0 && [ns, before_ns].iter().all(|ns| ns % unit_ns == 0) {
            let goes_on = |span: &&i64| {
                let on_ns = ns.saturating_add(**span).saturating_sub(before_ns);
                before_ns < **span
                    && (1..=Self::STEPS.saturating_mul(self.steps_ns[0].min(self.steps_ns[1])))
                        .contains(&on_ns)
            };
            if let Some(span) = spans.iter().find(goes_on) {
                self.added_ns = self.added_ns.saturating_add(*span);
                self.count += 1;
            }
        }
        ns.saturating_add(self.added_ns)
    }

    /// What the times of a column are whole multiples of, and after what they may begin again, ns.
    fn spans_ns(source: &TimeSource) -> Option<(i64, [i64; 2])> {
        match source {
            TimeSource::Number { unit, .. } => {
                let unit_ns = whole_ns(unit.factor).filter(|one| *one > 0 && unit.zero_ns() == 0)?;
                Some((unit_ns, [16, 32].map(|bits| unit_ns.saturating_mul(1 << bits))))
            }
            // Tables that show the time of a day as mm:ss.s.
            TimeSource::Date { form, .. } if form.part == Part::Minutes => Some((1, [Self::HOUR_NS; 2])),
            _ => None,
        }
    }

    const HOUR_NS: i64 = 3_600_000_000_000;

    /// The same with nothing counted.
    pub(super) fn going_on(&self) -> Self {
        Self { count: 0, ..self.clone() }
    }

    /// Says what was undone.
    pub(super) fn remark(&self, remarks: &mut Remarks) {
        let message =
            "places where the clock, its bits full or its hour over, begins again; the time goes on there";
        remarks.add(Code::ClockJump, self.count, message);
    }
}

/// The number of a cell, and the unit of time that some programs write behind each: `0.25 sec`.
pub(super) fn with_unit(cell: &[u8]) -> (&[u8], Option<Unit>) {
    let found = number::with_unit(cell).filter(|(_, unit)| unit.measure == Measure::Time);
    found.map_or((cell.trim_ascii(), None), |(digits, unit)| (digits, Some(unit)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_time_of_day_goes_on_after_midnight() {
        let cells = [b"23:59:59,98".as_slice(), b"00:00:00,00"];
        let form = DateForm::fitting(&cells.into_iter()).remove(0);
        let mut ns: Vec<i64> = cells.iter().filter_map(|cell| form.ns(cell)).collect();
        let absolute = TimeSource::Date { column: 0, form }.settle(&mut ns);
        assert_eq!((ns[1] - ns[0], absolute), (20_000_000, false));
    }

    #[test]
    fn a_counter_that_begins_again_goes_on_and_a_clock_that_does_not() {
        let steps = |unit: &str, bits: u32, from: i64| {
            let unit = crate::log::csv::unit::parse_unit(unit).unwrap();
            let source = TimeSource::Number { column: 0, unit };
            let unit_ns = whole_ns(unit.factor).unwrap();
            let mut wraps = Wraps::default();
            let stamp = |k: i64| (from + 10 * k).rem_euclid(1 << bits) * unit_ns;
            let ns: Vec<i64> = (0..100).map(|k| wraps.undone(&source, stamp(k))).collect();
            (ns.windows(2).all(|two| two[1] - two[0] == 10 * unit_ns), wraps.count)
        };
        assert_eq!(steps("us", 32, (1 << 32) - 555), (true, 1));
        assert_eq!(steps("ms", 16, (1 << 16) - 55), (true, 1));
        assert_eq!(steps("ms", 20, (1 << 20) - 55), (false, 0));
        assert_eq!(steps("s", 32, 0), (true, 0));
    }

    #[test]
    fn minutes_without_hours_go_on_after_the_hour_and_a_run_that_begins_again_does_not() {
        let cells = ["59:59.8", "59:59.9", "00:00.0", "00:00.1", "00:09.0", "00:00.0"];
        let form = DateForm::fitting(&cells.iter().map(|cell| cell.as_bytes())).pop().unwrap();
        let source = TimeSource::Date { column: 0, form: form.clone() };
        let mut wraps = Wraps::default();
        let ns = cells.map(|cell| wraps.undone(&source, form.ns(cell.as_bytes()).unwrap()));
        assert_eq!(ns.map(|ns| ns / 100_000_000), [35_998, 35_999, 36_000, 36_001, 36_090, 36_000]);
        assert_eq!(wraps.count, 1);
    }
}
