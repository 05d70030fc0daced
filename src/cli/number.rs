//! Numbers on the command line. Degrees, milliseconds and percent become SI here.

use std::convert::identity;

use crate::units::radians_from_degrees;

/// A number within bounds; `what` names it in the error.
pub(super) fn within(text: &str, bounds: [f64; 2], what: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(value) if (bounds[0]..=bounds[1]).contains(&value) => Ok(value),
        _ => Err(format!("{text:?} is not {what}")),
    }
}

/// Parsers of options: bounds, what is expected, and how it becomes SI.
macro_rules! numbers {
    ($($(#[$doc:meta])* $name:ident($least:expr, $most:expr, $what:expr, $si:expr);)*) => {
        $($(#[$doc])*
        pub(super) fn $name(text: &str) -> Result<f64, String> {
            within(text, [$least, $most], $what).map($si)
        })*
    };
}

const fn thousandth(value: f64) -> f64 {
    value / 1e3
}

const fn hundredth(value: f64) -> f64 {
    value / 100.0
}

numbers! {
    degrees(0.0, f64::MAX, "a non-negative angle in degrees", radians_from_degrees);
    speed_deg_s(0.1, 1000.0, "a speed from 0.1 to 1000 deg/s", radians_from_degrees);
    speed_mm_s(1.0, 10_000.0, "a speed from 1 to 10000 mm/s", thousandth);
    millimetres(0.0, f64::MAX, "a non-negative length in millimetres", thousandth);
    correction_deg(0.0, 57.0, "an angle from 0 to 57 deg", radians_from_degrees);
    correction_mm(0.0, 1000.0, "a length from 0 to 1000 mm", thousandth);
    milliseconds(0.0, f64::MAX, "a non-negative time in milliseconds", thousandth);
    /// A negative one allows some growth.
    reduction_percent(f64::MIN, 100.0, "a percentage of at most 100", hundredth);
    growth_percent(0.0, 1000.0, "a number from 0 to 1000", hundredth);
    share(0.0, 1.0, "a number from 0 to 1", identity);
    probability(0.0, 1.0, "a probability from 0 to 1", identity);
    ratio(0.0, f64::MAX, "a non-negative ratio", identity);
    positive(f64::MIN_POSITIVE, f64::MAX, "a number above 0", identity);
    seconds(0.0, f64::MAX, "a non-negative time in seconds", identity);
    any_seconds(f64::MIN, f64::MAX, "a time in seconds", identity);
    rate_hz(1.0, 10_000.0, "a rate from 1 to 10000 Hz", identity);
}

/// Milliseconds of a delay, as nanoseconds.
#[expect(clippy::cast_possible_truncation, reason = "bounded")]
pub(super) fn delay_ns(text: &str) -> Result<i64, String> {
    let ms = within(text, [-1e4, 1e4], "a delay from -10000 to 10000 ms")?;
    Ok((ms * 1e6).round() as i64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn degrees_milliseconds_and_percent_become_si_at_the_edge() {
        assert_eq!(degrees("180"), Ok(std::f64::consts::PI));
        assert_eq!(milliseconds("250"), Ok(0.25));
        assert_eq!(growth_percent("10"), Ok(0.1));
        assert_eq!(reduction_percent("-50"), Ok(-0.5));
        assert!(["-1", "inf", "NaN", "x", ""].iter().all(|text| degrees(text).is_err()));
        assert!(positive("0").is_err() && share("1.1").is_err() && rate_hz("0.5").is_err());
    }
}
