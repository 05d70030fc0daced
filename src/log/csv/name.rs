//! Reads the name of a joint from the words of a header.

use super::word::{Meaning, Word};

/// Words that say nothing behind one that says a role.
const FILLERS: [&str; 4] = ["value", "values", "point", "state"];

/// The joint of a header that names none.
pub(super) const NAMELESS: &str = "joint";

/// What is left of the words once role and quantity are gone; `joint_3` where that is a number,
/// [`NAMELESS`] where nothing is left.
pub(super) fn joint_name(words: &[Word<'_>]) -> String {
    let mut name = String::new();
    let mut gap = false;
    for (at, word) in words.iter().enumerate() {
        // The type of a variable of a controller: `fActPos`, `lrSetPosition`.
        let typed = ["f", "r", "lr"].contains(&word.text)
            && words.get(at + 1).is_some_and(|next| !next.apart && matches!(next.meaning, Meaning::Role(_)));
        // `set_point`, `actual value`.
        let filler = FILLERS.iter().any(|filler| word.text.eq_ignore_ascii_case(filler))
            && at.checked_sub(1).is_some_and(|before| matches!(words[before].meaning, Meaning::Role(_)));
        if typed || filler || matches!(word.meaning, Meaning::Role(_) | Meaning::Quantity(_) | Meaning::Time)
        {
            gap = true;
            continue;
        }
        if !name.is_empty() && (word.apart || gap) {
            // A name of ROS keeps its namespace.
            name.push(if word.slashed && !gap { '/' } else { '_' });
        }
        name.push_str(word.text);
        gap = false;
    }
    if name.is_empty() {
        return NAMELESS.to_owned();
    }
    if name.chars().all(|c| c.is_ascii_digit()) { format!("joint_{name}") } else { name }
}
