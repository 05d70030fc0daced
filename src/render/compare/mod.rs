//! What a change did to the tracking error of a task.

mod document;
mod figures;
mod page;
mod short;
mod tables;

pub use document::compare_json as json;
pub use figures::figures;
pub use page::page;
pub use short::verdicts;
pub use tables::document;

use super::kit::{NONE, deg, ms, optional};
use crate::workflow::compare::{Change, Measure, Verdict};

/// How a measure is shown, and its unit.
fn unit(measure: Measure) -> (fn(f64) -> String, &'static str) {
    match measure {
        Measure::PeakError | Measure::RmsError => (deg, "deg"),
        Measure::OnsetDelay => (ms, "ms"),
    }
}

/// `before -> after`; nothing where neither is known.
fn arrow(change: &Change, show: fn(f64) -> String) -> String {
    match (change.before, change.after) {
        (None, None) => NONE.to_owned(),
        (before, after) => format!("{} -> {}", optional(before, show), optional(after, show)),
    }
}

fn word(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Smaller => "smaller",
        Verdict::Larger => "larger",
        Verdict::NotShown => "not shown",
        Verdict::Equal => "equal",
        Verdict::TooFew => "too few",
    }
}
