//! What a transition is called.

use super::kit::{NONE, ms};
use crate::replay::{Answer, Kind};

pub(super) fn kind(kind: Kind) -> &'static str {
    match kind {
        Kind::Start => "start",
        Kind::Reversal => "reversal",
    }
}

pub(super) fn direction(direction: i8) -> &'static str {
    if direction < 0 { "-" } else { "+" }
}

/// A delay in milliseconds, or why there is none.
pub(super) fn late(delay_s: Option<f64>, answer: Answer) -> String {
    delay_s.map_or_else(|| answer_word(answer).to_owned(), ms)
}

pub(super) fn answer_word(answer: Answer) -> &'static str {
    match answer {
        // Means over runs lack a delay that single runs have.
        Answer::Timed => NONE,
        Answer::Unclear => "unclear",
        Answer::Creeps => "creeps",
        Answer::Never => "never",
    }
}
