//! When a run began: as its stamps say, or its name, where they count from zero.

use std::ops::RangeInclusive;

use chrono::{NaiveDate, NaiveDateTime};

use crate::{
    remark::{Code, Remark},
    units::SECONDS_PER_DAY,
};

/// Names of the log and of so many folders above it are looked at.
const NAMES: usize = 4;
/// Years of a recording.
const YEARS: RangeInclusive<i32> = 1990..=2099;

/// When a run began, ns since 1970, as its stamps say if they say a date; `None` of one whose name holds none either.
///
/// A date is `2026-03-06` or `20260306`, with `-`, `_`, `.` or nothing between its parts, or `06.03.2026`; a time of day may
/// follow as `08-15`, `0815` or `081530`. The log's own name counts before those of its folders; of several dates in one name the
/// latest counts.
pub(in crate::workflow) fn began_ns(uri: &str, stamped_ns: Option<i64>) -> Option<i64> {
    let named = || uri.trim_end_matches('/').rsplit('/').take(NAMES).find_map(date_in);
    stamped_ns.or_else(|| named()?.and_utc().timestamp_nanos_opt())
}

/// Stamps and name of a run that say dates so far apart may not be of one clock, days; a folder may be that of a month.
const DOUBTED_DAYS: f64 = 31.0;
/// Those so far apart are not.
const OTHER_DATE_DAYS: f64 = 180.0;

/// When a run began by the name of its log, or of its folder, where that says a date far from that of its stamps, microseconds
/// since 1970; and whether it is so far that the stamps cannot be right. Folders farther up may be of a delivery, or a number; digits
/// that follow a letter, as of `EX20240501`, may be a serial number, too. The time of day is that of the stamps where the name says none.
pub(super) fn named_otherwise(uri: &str, started_us: i64) -> Option<(i64, bool)> {
    const DAY_US: i64 = 86_400_000_000;
    let mut names = uri.trim_end_matches('/').rsplit('/').take(2);
    let (name, named) = names.find_map(|name| Some((name, date_in(name)?)))?;
    let apart = date_apart_in(name) == Some(named);
    let named_us = named.and_utc().timestamp_micros();
    let apart_s = named_us.abs_diff(started_us) as f64 / 1e6;
    let of_day = named_us.rem_euclid(DAY_US) == 0;
    let us = if of_day { named_us + started_us.rem_euclid(DAY_US) } else { named_us };
    let beyond = |days: f64| apart_s > days * SECONDS_PER_DAY;
    beyond(DOUBTED_DAYS).then(|| (us, apart && beyond(OTHER_DATE_DAYS)))
}

/// The doubt about a run without one.
pub(super) fn undated() -> Remark {
    let message = "neither the stamps nor the name of the run say a date".to_owned();
    Remark { code: Code::Undated, count: 1, message }
}

fn date_in(name: &str) -> Option<NaiveDateTime> {
    date_behind(name, |before| !before.is_ascii_digit())
}

/// The same that follows no letter.
fn date_apart_in(name: &str) -> Option<NaiveDateTime> {
    date_behind(name, |before| !before.is_ascii_alphanumeric())
}

/// A run is later than the plan or the revision that its name says too.
fn date_behind(name: &str, may_stand: impl Fn(u8) -> bool) -> Option<NaiveDateTime> {
    let bytes = name.as_bytes();
    let begins = |at: &usize| *at == 0 || may_stand(bytes[*at - 1]);
    (0..bytes.len()).filter(begins).filter_map(|at| date_at(&bytes[at..])).max()
}

fn date_at(text: &[u8]) -> Option<NaiveDateTime> {
    let (date, rest) = year_first(text).or_else(|| day_first(text))?;
    let after = separator(rest, b"T-_ ").1;
    let time = time_at(after).filter(|_| year_first(after).is_none());
    let timed = time.and_then(|[h, m, s]| date.and_hms_opt(h, m, s));
    // More digits are no date: a serial number.
    let ends = !rest.first().is_some_and(u8::is_ascii_digit);
    timed.or_else(|| if ends { date.and_hms_opt(0, 0, 0) } else { None })
}

/// Points alone stand between a day and its month; other signs do so between a month and its day elsewhere.
fn day_first(text: &[u8]) -> Option<(NaiveDate, &[u8])> {
    let short = |text| digits(text, 2).or_else(|| digits(text, 1));
    let (day, rest) = short(text)?;
    let (month, rest) = short(rest.strip_prefix(b".")?)?;
    let (year, rest) = digits(rest.strip_prefix(b".")?, 4)?;
    let year = i32::try_from(year).ok().filter(|year| YEARS.contains(year))?;
    Some((NaiveDate::from_ymd_opt(year, month, day)?, rest))
}

fn year_first(text: &[u8]) -> Option<(NaiveDate, &[u8])> {
    let (year, rest) = digits(text, 4)?;
    let (between, rest) = separator(rest, b"-_.");
    let (month, rest) = digits(rest, 2)?;
    let (again, rest) = separator(rest, b"-_.");
    let (day, rest) = digits(rest, 2)?;
    let year = i32::try_from(year).ok().filter(|year| YEARS.contains(year) && between == again)?;
    Some((NaiveDate::from_ymd_opt(year, month, day)?, rest))
}

/// Hours, minutes and seconds.
fn time_at(text: &[u8]) -> Option<[u32; 3]> {
    let (hours, rest) = digits(text, 2)?;
    let (between, rest) = separator(rest, b"-_:.h");
    let (minutes, rest) = digits(rest, 2)?;
    let (again, after) = separator(rest, b"-_:.m");
    let seconds = digits(after, 2).filter(|_| (between == 0) == (again == 0));
    let (seconds, rest) = seconds.unwrap_or((0, rest));
    (!rest.first().is_some_and(u8::is_ascii_digit)).then_some([hours, minutes, seconds])
}

/// A number of so many digits, and what follows.
fn digits(text: &[u8], count: usize) -> Option<(u32, &[u8])> {
    let (number, rest) = text.split_at_checked(count)?;
    let number = number
        .iter()
        .try_fold(0, |sum, digit| digit.is_ascii_digit().then(|| 10 * sum + u32::from(digit - b'0')));
    Some((number?, rest))
}

/// One of some characters, 0 for none of them, and what follows.
fn separator<'a>(text: &'a [u8], some: &[u8]) -> (u8, &'a [u8]) {
    match text.split_first() {
        Some((first, rest)) if some.contains(first) => (*first, rest),
        _ => (0, text),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_clock_that_is_a_year_off_is_told_by_the_name() {
        let day_us = 1_772_323_200_000_000; // 2026-03-01
        let hour_us = 3_600_000_000;
        for (uri, named_us) in [
            ("/logs/M1/2025-03-01/run.csv", Some(day_us - 365 * 24 * hour_us + 9 * hour_us)),
            ("/logs/M1/2025-03-01_0700.csv", Some(day_us - 365 * 24 * hour_us + 7 * hour_us)),
            ("/logs/M1/run_2026-02-27.csv", None),
            ("/logs/M1/run_2026-01-11.csv", Some(day_us - 49 * 24 * hour_us + 9 * hour_us)),
            ("/logs/delivery_2024-01-05/M1/run.csv", None),
        ] {
            let found = named_otherwise(uri, day_us + 9 * hour_us);
            assert_eq!(found.map(|(us, _)| us), named_us, "{uri}");
            assert!(found.is_none_or(|(_, surely)| surely == uri.contains("2025")), "{uri}");
        }
        let serial = named_otherwise("/logs/EX20240501/run.csv", day_us);
        assert!(matches!(serial, Some((_, false))), "a serial number may look like a date: {serial:?}");
    }

    #[test]
    fn names_tell_the_date_that_stamps_do_not() {
        for (uri, found) in [
            ("/data/M07/run_2026-03-06_08-15-30.csv", "2026-03-06 08:15:30"),
            ("/data/M07/2026-03-06/run-3.csv", "2026-03-06 00:00:00"),
            ("trace20260306_0815.csv", "2026-03-06 08:15:00"),
            ("20260306081530.csv", "2026-03-06 08:15:30"),
            ("s3://logs/2025_01_02/2026.03.06.csv", "2026-03-06 00:00:00"),
            ("2026-03-06T08:15.csv/", "2026-03-06 08:15:00"),
            ("2026-03-06-run7.csv", "2026-03-06 00:00:00"),
            ("trace 6.3.2026 8-15.csv", "2026-03-06 00:00:00"),
            ("M7/06.03.2026/run_08-15.csv", "2026-03-06 00:00:00"),
            ("06.03.2026_0815.csv", "2026-03-06 08:15:00"),
            ("rev2025-11-20_2026-03-06.csv", "2026-03-06 00:00:00"),
            ("2026-03-06_0815_plan_2025-11-20.csv", "2026-03-06 08:15:00"),
        ] {
            let ns = began_ns(uri, None).unwrap();
            let at = chrono::DateTime::from_timestamp_nanos(ns).format("%Y-%m-%d %H:%M:%S").to_string();
            assert_eq!(at, found, "{uri}");
        }
        for uri in [
            "run.csv", "2026-13-06.csv", "2026-0306.csv", "120260306.csv", "202603061.csv", "06-03-2026.csv",
            "1.2.3.4.csv", "106.03.2026.csv", "1234-05-06", "",
        ] {
            assert_eq!(began_ns(uri, None), None, "{uri}");
        }
        assert_eq!(
            began_ns("2026-03-06.csv", Some(1_700_000_000_000_000_000)),
            Some(1_700_000_000_000_000_000)
        );
    }
}
