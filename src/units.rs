//! The one place where radians become degrees and nanoseconds become seconds.
//!
//! Inside the crate angles are radians; only the edges (`cli`, `report`, `viewer`, task files)
//! call these conversions, and a test keeps it so.

/// Nanoseconds in a second.
pub const NS_PER_S: f64 = 1e9;

/// Seconds in a day.
pub const SECONDS_PER_DAY: f64 = 86_400.0;

/// One degree, rad. Thresholds that the literature states in degrees are written as multiples.
pub const DEGREE_RAD: f64 = std::f64::consts::PI / 180.0;

/// Degrees as people read them, from radians.
pub fn degrees_from_radians(rad: f64) -> f64 {
    rad.to_degrees()
}

/// Radians, from degrees as people type them.
pub fn radians_from_degrees(deg: f64) -> f64 {
    deg.to_radians()
}

/// An angle, rad, as people read it in messages.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Degrees(pub f64);

impl std::fmt::Display for Degrees {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{:.2} deg", degrees_from_radians(self.0))
    }
}

/// Whole nanoseconds, from seconds; those of a log are few.
#[expect(clippy::cast_possible_truncation, reason = "a log lasts less than centuries")]
pub fn nanoseconds(t_s: f64) -> i64 {
    (t_s * NS_PER_S).round() as i64
}

/// Nanoseconds, rounded; `None` beyond what an `i64` holds.
#[expect(clippy::cast_possible_truncation, reason = "range checked")]
pub fn whole_ns(ns: f64) -> Option<i64> {
    (ns.abs() < 9.0e18).then(|| ns.round() as i64)
}

/// Seconds from `epoch_ns` to `stamp_ns`, s. Exact to below a nanosecond within 104 days.
pub fn seconds_since(epoch_ns: i64, stamp_ns: i64) -> f64 {
    let since_ns = match stamp_ns.checked_sub(epoch_ns) {
        Some(ns) => ns as f64,
        None => (i128::from(stamp_ns) - i128::from(epoch_ns)) as f64,
    };
    since_ns / NS_PER_S
}
