//! What a change did to the tracking error of a task.

mod document;
mod short;
mod tables;

pub use document::compare_json;
pub use short::compare_gate_lines;
pub use tables::compare_parts;
pub(super) use tables::run_facts;

use super::{NONE, deg, ms};
use crate::workflow::compare::{Change, Measure, Verdict};

/// How a measure is shown, and its unit.
fn unit(measure: Measure) -> (fn(f64) -> String, &'static str) {
    match measure {
        Measure::PeakError | Measure::RmsError => (deg, "deg"),
        Measure::OnsetDelay => (ms, "ms"),
    }
}

/// A difference with its sign.
pub(super) fn signed(value: f64, show: fn(f64) -> String) -> String {
    let text = show(value);
    let zero = text.chars().all(|c| matches!(c, '0' | '.'));
    if zero || text.starts_with('-') { text } else { format!("+{text}") }
}

/// A share as whole percent with its sign.
pub(super) fn percent(share: f64) -> String {
    signed(share, |share| {
        let text = format!("{:.0}", 100.0 * share);
        if text == "-0" { "0".to_owned() } else { text }
    })
}

pub(super) fn probability(p: f64) -> String {
    if p < 0.001 { format!("{p:.1e}") } else { format!("{p:.3}") }
}

fn optional(value: Option<f64>, show: impl Fn(f64) -> String) -> String {
    value.map_or(NONE.to_owned(), show)
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
