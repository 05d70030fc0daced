//! Runs of one day, which share oil, load and weather.

/// A pause of so long ends a day's work, and no day is longer, microseconds.
const PAUSE_US: i64 = 8 * 3_600_000_000;
const LONGEST_US: i64 = 20 * 3_600_000_000;

/// Whether a run is of the day whose first and last runs so far began at these instants, microseconds since 1970.
pub(super) fn is_of_day([first_us, last_us]: [i64; 2], began_us: i64) -> bool {
    began_us - last_us < PAUSE_US && began_us - first_us < LONGEST_US
}

/// Of how many days runs are that began at these instants.
pub(super) fn days(mut began_us: Vec<i64>) -> usize {
    began_us.sort_unstable();
    let mut days: Vec<[i64; 2]> = Vec::new();
    for at_us in began_us {
        match days.last_mut().filter(|day| is_of_day(**day, at_us)) {
            Some(day) => day[1] = at_us,
            None => days.push([at_us; 2]),
        }
    }
    days.len()
}
