//! A unit that stands as a word within a name: `j1_deg_actual`, `boom_mm_s_set`.

use super::{
    Quantity,
    scale::unit_named,
    unit::{ANOTHER, Unit},
    word::{Meaning, Word},
};

/// Units that are words of their own; a single letter is more often a part of a name.
const UNITS: [&str; 8] = ["deg", "degree", "degrees", "mdeg", "rad", "mrad", "mm", "cm"];

/// Words behind a unit that make it one a second.
const PER_SECOND: [&[&str]; 5] = [&["s"], &["sec"], &["per", "s"], &["per", "sec"], &["per", "second"]];

/// Numbers that make another unit of one.
const SCALES: [&str; 3] = ["10", "100", "1000"];

/// Takes a unit out of the words; the first of them names the joint, and of two units neither is meant.
pub(super) fn take_unit(words: &mut Vec<Word<'_>>) -> Option<Unit> {
    let whole = |at: usize| words[at].apart && words.get(at + 1).is_none_or(|next| next.apart);
    let is = |at: usize, one: &str| words[at].text.eq_ignore_ascii_case(one);
    let mut found = (1..words.len()).filter(|&at| whole(at) && UNITS.iter().any(|unit| is(at, unit)));
    let (at, None) = (found.next()?, found.next()) else { return None };
    let unit = unit_named(words[at].text)?;
    // What counts the joints of an arm is no scale: a scale stands behind a joint that has a name.
    let named = words[..at].iter().any(|word| word.meaning == Meaning::Name && word.text.len() > 2);
    let scale = |word: &Word<'_>| SCALES.contains(&word.text);
    let power = words.get(at + 1).is_some_and(|next| next.text == "e")
        && words.get(at + 2).is_some_and(|next| next.text.bytes().all(|b| b.is_ascii_digit()));
    if named && (words[at + 1..].iter().any(scale) || power) {
        return Some(ANOTHER);
    }
    let follow = |behind: &&&[&str]| {
        behind.iter().zip(at + 1..).all(|(one, at)| at < words.len() && whole(at) && is(at, one))
    };
    if let Some(behind) = PER_SECOND.iter().find(follow) {
        words.drain(at..=at + behind.len());
        return Some(unit.per_second());
    }
    // In German a wheel is a `Rad`: radians stand behind what no joint is named by.
    let before = &words[at - 1];
    if is(at, "rad") && before.meaning == Meaning::Name && !before.text.bytes().all(|b| b.is_ascii_digit()) {
        return None;
    }
    // Of `boom_speed_deg_set` and `j1_deg_s2_set` the unit is not all that is meant.
    let speed = |word: &Word<'_>| {
        word.meaning == Meaning::Quantity(Quantity::Velocity) || word.text.eq_ignore_ascii_case("dot")
    };
    let more = words.get(at + 1).is_some_and(|next| ["s", "sec", "per"].contains(&next.text));
    if more || words.iter().any(speed) {
        return None;
    }
    words.remove(at);
    Some(unit)
}

#[cfg(test)]
mod tests {
    use super::{super::word::words, *};

    #[test]
    fn a_unit_within_is_a_whole_word_and_all_that_is_meant() {
        let said = |header: &str| {
            let mut words = words(header);
            let unit = take_unit(&mut words).map(|unit| unit.name);
            (unit, words.iter().map(|word| word.text).collect::<Vec<_>>().join(" "))
        };
        assert_eq!(said("j1_deg_actual"), (Some("deg"), "j 1 actual".into()));
        assert_eq!(said("angle_rad_1"), (Some("rad"), "angle 1".into()));
        assert_eq!(said("j1 rad per sec actual"), (Some("rad/s"), "j 1 actual".into()));
        assert_eq!(said("boom_mm_s_act"), (Some("mm/s"), "boom act".into()));
        for header in ["boom set [deg] x10", "boom_set_deg_e2", "boom_set_deg_10"] {
            assert_eq!(said(header).0, Some("another unit"), "{header}");
        }
        assert_eq!(said("joint_deg_10").0, Some("deg"));
        for header in [
            "vorn_rad_ist", "rad_1_ist", "arm_m_act", "deg2_act", "a_deg_mm_b", "grader_act",
            "boom_speed_deg_act", "theta_dot_deg_1", "j1_deg_s2_act",
        ] {
            assert_eq!(said(header).0, None, "{header}");
        }
    }
}
