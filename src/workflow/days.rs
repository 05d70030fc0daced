//! Runs of one day, which share oil, load and weather.

use std::ops::Range;

/// A pause of so long ends a day's work, and no day is longer, microseconds.
const PAUSE_US: i64 = 8 * 3_600_000_000;
const LONGEST_US: i64 = 20 * 3_600_000_000;

/// Days of runs that began at these instants, microseconds since 1970 in order; a day ends at each of `splits_us`, too.
pub(super) fn days(began_us: &[i64], splits_us: &[i64]) -> Vec<Range<usize>> {
    let mut days: Vec<Range<usize>> = Vec::new();
    for (k, at_us) in began_us.iter().enumerate() {
        let same = |day: &&mut Range<usize>| {
            let [first_us, last_us] = [began_us[day.start], began_us[k - 1]];
            let split = splits_us.iter().any(|split_us| (last_us + 1..=*at_us).contains(split_us));
            at_us - last_us < PAUSE_US && at_us - first_us < LONGEST_US && !split
        };
        match days.last_mut().filter(same) {
            Some(day) => day.end = k + 1,
            None => days.push(k..k + 1),
        }
    }
    days
}
