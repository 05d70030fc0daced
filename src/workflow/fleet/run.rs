//! One run, and when it began.

use crate::{log::is_dated, units::SECONDS_PER_DAY};

/// One run.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Run {
    pub(super) id: String,
    pub(super) machine: String,
    pub(super) log: String,
    /// Microseconds since 1970.
    pub(super) started_us: i64,
}

impl Run {
    /// Whether anybody knows when it began.
    pub(super) fn is_dated(&self) -> bool {
        is_dated(self.started_us.saturating_mul(1000))
    }
}

/// Days since 1970.
pub(super) fn days(run: &Run) -> f64 {
    run.started_us as f64 / 1e6 / SECONDS_PER_DAY
}

/// An instant as people and machines read it.
pub(super) fn date(days: f64) -> Option<String> {
    #[expect(clippy::cast_possible_truncation, reason = "days of runs are few")]
    let us = (days * SECONDS_PER_DAY).round() as i64;
    chrono::DateTime::from_timestamp(us, 0).map(|at| at.format("%Y-%m-%dT%H:%M:%SZ").to_string())
}
