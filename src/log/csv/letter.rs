//! Reads a letter of a header that may say a role.

use super::{
    Role,
    name::joint_name,
    word::{Meaning, Word},
};

/// Role, key and name of the joint if the letter of `q_d_1` or `q1_m` is no part of its name.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Lettered {
    pub(super) role: Role,
    pub(super) key: String,
    pub(super) joint: String,
}

/// Letters behind a quantity, or behind that and a number, that may say a role: desired, reference, measured, actual.
const LETTERS: [(&str, Role); 4] =
    [("d", Role::Planned), ("r", Role::Planned), ("m", Role::Measured), ("a", Role::Measured)];

/// What the words say if a letter behind the quantity, or behind that and a number, is a role.
pub(super) fn lettered(words: &[Word<'_>]) -> Option<Lettered> {
    let quantity = words.iter().position(|word| matches!(word.meaning, Meaning::Quantity(_)))?;
    let number = |word: &Word<'_>| word.text.bytes().all(|byte| byte.is_ascii_digit());
    let at = quantity + 1 + usize::from(words.get(quantity + 1).is_some_and(number));
    let (_, role) =
        LETTERS.iter().find(|(letter, _)| words[at..].first().is_some_and(|word| word.text == *letter))?;
    let kept: Vec<Word> =
        words.iter().enumerate().filter(|(index, _)| *index != at).map(|(_, word)| word.clone()).collect();
    let joint = joint_name(&kept);
    Some(Lettered { role: *role, key: joint.to_lowercase(), joint })
}
