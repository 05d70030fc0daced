//! Numbers on the command line. Degrees, milliseconds and percent become SI here.

use crate::units::radians_from_degrees;

/// A number within bounds; `what` names it in the error.
pub(super) fn within(text: &str, bounds: [f64; 2], what: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(value) if (bounds[0]..=bounds[1]).contains(&value) => Ok(value),
        _ => Err(format!("{text:?} is not {what}")),
    }
}

pub(super) fn not_negative(text: &str, what: &str) -> Result<f64, String> {
    within(text, [0.0, f64::MAX], &format!("a non-negative {what}"))
}

/// Degrees, as radians.
pub(super) fn degrees(text: &str) -> Result<f64, String> {
    not_negative(text, "angle in degrees").map(radians_from_degrees)
}

/// Degrees a second above zero, as radians a second.
pub(super) fn speed_deg_s(text: &str) -> Result<f64, String> {
    within(text, [0.1, 1000.0], "a speed from 0.1 to 1000 deg/s").map(radians_from_degrees)
}

/// Millimetres a second above zero, as metres a second.
pub(super) fn speed_mm_s(text: &str) -> Result<f64, String> {
    within(text, [1.0, 10_000.0], "a speed from 1 to 10000 mm/s").map(|mm_s| mm_s / 1e3)
}

/// Millimetres, as metres.
pub(super) fn millimetres(text: &str) -> Result<f64, String> {
    not_negative(text, "length in millimetres").map(|mm| mm / 1e3)
}

/// Millimetres of a correction, as metres.
pub(super) fn correction_mm(text: &str) -> Result<f64, String> {
    within(text, [0.0, 1000.0], "a length from 0 to 1000 mm").map(|mm| mm / 1e3)
}

/// Milliseconds, as seconds.
pub(super) fn milliseconds(text: &str) -> Result<f64, String> {
    not_negative(text, "time in milliseconds").map(|ms| ms / 1e3)
}

/// Milliseconds of a delay, as nanoseconds.
#[expect(clippy::cast_possible_truncation, reason = "bounded")]
pub(super) fn delay_ns(text: &str) -> Result<i64, String> {
    let ms = within(text, [-1e4, 1e4], "a delay from -10000 to 10000 ms")?;
    Ok((ms * 1e6).round() as i64)
}

/// Percent, as a share; a negative reduction allows some growth.
pub(super) fn reduction_percent(text: &str) -> Result<f64, String> {
    within(text, [f64::MIN, 100.0], "a percentage of at most 100").map(|percent| percent / 100.0)
}

/// Percent, as a share.
pub(super) fn growth_percent(text: &str) -> Result<f64, String> {
    within(text, [0.0, 1000.0], "a number from 0 to 1000").map(|percent| percent / 100.0)
}

pub(super) fn share(text: &str) -> Result<f64, String> {
    within(text, [0.0, 1.0], "a number from 0 to 1")
}

pub(super) fn probability(text: &str) -> Result<f64, String> {
    within(text, [0.0, 1.0], "a probability from 0 to 1")
}

pub(super) fn ratio(text: &str) -> Result<f64, String> {
    not_negative(text, "ratio")
}

pub(super) fn positive(text: &str) -> Result<f64, String> {
    within(text, [f64::MIN_POSITIVE, f64::MAX], "a number above 0")
}

pub(super) fn seconds(text: &str) -> Result<f64, String> {
    not_negative(text, "time in seconds")
}

pub(super) fn any_seconds(text: &str) -> Result<f64, String> {
    within(text, [f64::MIN, f64::MAX], "a time in seconds")
}

pub(super) fn rate_hz(text: &str) -> Result<f64, String> {
    within(text, [1.0, 10_000.0], "a rate from 1 to 10000 Hz")
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
