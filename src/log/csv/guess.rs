//! Guesses the unit of a time that says none.

use super::unit::{DATENUM, EXCEL_DAY, FILETIME, TICKS, Unit, parse_unit};
use crate::math::median;

/// The step between most neighbours that do not stand; 0 if all do.
pub(super) fn typical_step(values: &[f64]) -> f64 {
    let steps: Vec<f64> = values.windows(2).map(|w| (w[1] - w[0]).abs()).filter(|step| *step > 0.0).collect();
    if steps.is_empty() { 0.0 } else { median(steps) }
}

/// Seconds from 2001 to 2103, since 1970.
pub(super) const SINCE_1970_S: [f64; 2] = [1.0e9, 4.2e9];
/// From 2000 to 2100.
pub(super) const SINCE_1899_DAYS: [f64; 2] = [36_526.0, 73_051.0];
const SINCE_0_DAYS: [f64; 2] = [730_486.0, 767_011.0];

/// Arms are recorded at up to 2000 Hz.
const FASTEST_S: f64 = 0.000_5;
/// Shorter steps are none of seconds: fractions of days, as one program writes dates, come so.
const NO_CLOCK_S: f64 = 1e-5;
/// Steps of some minutes or hours, too, where they are round as steps of clocks are.
const SHORT_S: f64 = 0.002;

/// Whether a step is one that people set a clock to: 1, 2, 5 ms, 8 kHz.
fn is_round(step_s: f64) -> bool {
    const ROUND: [f64; 8] = [1.0, 1.25, 2.0, 2.5, 4.0, 5.0, 8.0, 10.0];
    let mantissa = step_s / 10_f64.powf(step_s.log10().floor());
    ROUND.iter().any(|round| (mantissa / round - 1.0).abs() < 0.002)
}

/// The unit of a column that names none: by its size if it counts from 1970, or else the one in
/// which the rows come at 2 to 2000 Hz; fractions may be of minutes or hours. `counts`: it rises by 1 in every row.
pub(super) fn guess_unit(first: f64, step: f64, whole: bool, counts: bool) -> (Option<Unit>, Option<String>) {
    // From 1995 to 2130, and to 2038.
    const SINCE_1601: [f64; 2] = [1.243e17, 1.67e17];
    const SINCE_1: [f64; 2] = [6.29e17, 6.43e17];
    if whole && (SINCE_1601[0]..SINCE_1601[1]).contains(&first) {
        return (Some(FILETIME), None);
    }
    if whole && (SINCE_1[0]..SINCE_1[1]).contains(&first) {
        let doubt = "says no unit; numbers of this size are taken as steps of 100 ns since the year 1 (.NET), else say --time-unit";
        return (Some(TICKS), Some(doubt.to_owned()));
    }
    if !whole && (SINCE_1899_DAYS[0]..SINCE_1899_DAYS[1]).contains(&first) && step < 1e-4 {
        return (Some(EXCEL_DAY), None);
    }
    if !whole && (SINCE_0_DAYS[0]..SINCE_0_DAYS[1]).contains(&first) && step < 1e-4 {
        let doubt = "says no unit; numbers of this size are taken as days since year 0, as MATLAB counts them (datenum), else \
                     say --time-unit";
        return (Some(DATENUM), Some(doubt.to_owned()));
    }
    for (name, per_second) in [("s", 1.0), ("ms", 1e3), ("us", 1e6)] {
        let (size, step_s) = (first / per_second, step / per_second);
        if (SINCE_1970_S[0]..SINCE_1970_S[1]).contains(&size) && step_s <= 10.0 {
            return (parse_unit(name), None);
        }
    }
    if !whole && step > 0.0 && step < SHORT_S {
        let round =
            [("s", 1.0), ("min", 60.0), ("h", 3600.0)].into_iter().find(|(_, per)| is_round(step * per));
        if round.is_none() && step < NO_CLOCK_S {
            return (None, None);
        }
        let (name, per) = round.unwrap_or(("s", 1.0));
        let doubt = format!(
            "says no unit; steps of {step:.3e} are taken as {name}, so that {:.0} rows come a second; else say --time-unit \
             s, min or h",
            (step * per).recip()
        );
        let sure = name == "s" && step >= FASTEST_S;
        return (parse_unit(name), (!sure).then_some(doubt));
    }
    for (name, least, most) in
        [("s", FASTEST_S, 0.5), ("ms", 0.5, 500.0), ("us", 500.0, 5e5), ("ns", 5e5, 5e8)]
    {
        if (least..most).contains(&step) {
            let sure = name == "s" && !whole;
            let doubt = if counts {
                "says no unit and rises by 1 in every row: it is taken as ms, at 1000 rows a second, but may count rows; then \
                 say --rate HZ, or --time-unit if it counts another time"
                    .to_owned()
            } else {
                format!("says no unit; steps of {step} are taken as {name}, else say --time-unit")
            };
            return (parse_unit(name), (!sure).then_some(doubt));
        }
    }
    (None, None)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn guess(first: f64, step: f64, whole: bool) -> (&'static str, bool) {
        let (unit, doubt) = guess_unit(first, step, whole, false);
        (unit.map_or("none", |unit| unit.name), doubt.is_some())
    }

    #[test]
    fn what_rises_by_1_in_every_row_may_count_rows() {
        let doubt = |counts| guess_unit(1101.0, 1.0, true, counts).1.unwrap();
        assert!(doubt(true).contains("--rate HZ") && doubt(true).contains("--time-unit"), "{}", doubt(true));
        assert!(!doubt(false).contains("--rate"), "{}", doubt(false));
    }

    #[test]
    fn a_unit_is_told_by_size_or_by_step() {
        assert_eq!(guess(1.75e9, 0.02, false), ("s", false));
        assert_eq!(guess(1.75e12, 20.0, true), ("ms", false));
        assert_eq!(guess(1.75e15, 20_000.0, true), ("us", false));
        assert_eq!(guess(12.3, 0.008, false), ("s", false));
        assert_eq!((guess(0.0, 0.001, false), guess(0.0, 0.000_98, false)), (("s", false), ("s", false)));
        assert_eq!((guess(0.0, 1e-4, false), guess(0.0, 0.000_125, false)), (("s", true), ("s", true)));
        assert_eq!(guess(0.0, 0.000_166_7, false), ("min", true));
        assert_eq!(guess(0.0, 0.001_666_7, false), ("min", true));
        assert_eq!(guess(0.0, 2.777_8e-6, false), ("h", true));
        assert_eq!(guess(739_323.4, 1.157e-7, false), ("days since year 0", true));
        assert_eq!(guess(0.0, 20.0, true), ("ms", true));
        assert_eq!(guess(0.0, 2e4, true), ("us", true));
        assert_eq!(guess(0.0, 2e7, true), ("ns", true));
        assert_eq!(guess(1.3393e17, 1e5, true), ("100 ns since 1601", false));
        assert_eq!(guess(45_811.375, 1.157e-7, false), ("days since 1899-12-30", false));
        assert_eq!(guess(45_811.375, 0.01, false), ("s", false));
        assert_eq!(guess(0.0, 0.0, true), ("none", false));
        assert_eq!(guess(0.0, 1e10, true), ("none", false));
    }
}
