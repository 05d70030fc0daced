//! Columns of a joint that are named by what they mean.

use std::collections::BTreeMap;

use super::{
    Columns, Quantity, Role,
    label::Label,
    word::{Meaning, words},
};

/// Words for the plan less the measurement.
const ERRORS: [&str; 15] = [
    "error", "err", "deviation", "abweichung", "regelabweichung", "regeldifferenz", "schleppfehler",
    "schleppabstand", "erreur", "écart", "errore", "lag", "diff", "误差", "ошибка",
];

/// What a caller names as the side of a joint that a word means.
pub(super) fn named_as<'a>(
    name: &str,
    joint: &str,
    given: &'a BTreeMap<(Role, Quantity), Columns>,
) -> Option<&'a str> {
    let [word] = words(name).try_into().ok()?;
    let Meaning::Role(role) = word.meaning else { return None };
    let own = given.get(&(role, Quantity::Position))?.iter().find(|(other, _)| other == joint)?;
    Some(&own.1)
}

/// The only column of a joint that is `measured`, `planned`, `command` or `error`.
pub(super) fn by_meaning(name: &str, joint: &str, labels: &[Label]) -> Option<usize> {
    let wanted = words(name);
    let [wanted] = wanted.as_slice() else { return None };
    let joint = joint.to_lowercase();
    let fits = |label: &Label| match wanted.meaning {
        Meaning::Role(role) => label.is_joint && label.key == joint && label.role == Some(role),
        Meaning::Foreign => {
            let said = |text: &str| label.words.iter().any(|word| word == text);
            let wanted = wanted.text.to_lowercase();
            // `error` is whatever a header calls it.
            let is_error = wanted == ERRORS[0] && ERRORS.iter().any(|word| said(word));
            (said(&wanted) || is_error) && !label.is_joint && words(&joint).iter().all(|word| said(word.text))
        }
        _ => false,
    };
    let mut found = (0..labels.len()).filter(|&column| fits(&labels[column]));
    found.next().filter(|_| found.next().is_none())
}

/// What makes the plan of joints that have a measurement and an error: `BOOM=measured+error,ARM=measured+error`.
pub(super) fn plan_by_error<'a>(joints: impl Iterator<Item = &'a str>, labels: &[Label]) -> Option<String> {
    let sum = |joint: &str| {
        let word = ERRORS.iter().find(|word| by_meaning(word, joint, labels).is_some())?;
        Some(format!("{joint}=measured+{word}"))
    };
    let sums: Option<Vec<String>> = joints.map(sum).collect();
    sums.map(|sums| sums.join(","))
}
