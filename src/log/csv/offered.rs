//! What a caller may say of a table in which no column looks like a joint's angle, though some come in pairs.

use super::{
    Quantity, Role,
    word::{Meaning, words},
};
use crate::text::shell_word;

/// Letters of the place of a tool, and of its orientation as some controllers tell it.
pub(super) const PLACE: [&str; 3] = ["x", "y", "z"];
pub(super) const ORIENTATION: [&str; 3] = ["a", "b", "c"];

/// Pairs that are written out.
const MOST: usize = 12;

/// Options that take columns as plan and measurement whose names differ by the words of the side alone: `target_x` and `actual_x`.
pub(super) fn offered(names: &[String]) -> Option<String> {
    let sides: Vec<(Role, String, &String)> = names.iter().filter_map(|name| of_column(name)).collect();
    let is = |role: Role, wanted: &Role| (role == Role::Measured) == (*wanted == Role::Measured);
    let pairs =
        sides.iter().filter(|(role, ..)| is(*role, &Role::Planned)).filter_map(|(_, key, planned)| {
            let mut others =
                sides.iter().filter(|(role, other, _)| is(*role, &Role::Measured) && other == key);
            let (_, _, measured) = others.next().filter(|_| others.next().is_none())?;
            Some((key, planned, measured))
        });
    let pairs: Vec<_> = pairs.take(MOST).collect();
    // `A`, `B` and `C` beside `X`, `Y` and `Z` turn.
    let has = |letter: &str| pairs.iter().any(|(key, ..)| *key == letter);
    let tool = PLACE.iter().chain(&ORIENTATION).all(|letter| has(letter));
    let slides: Vec<String> = pairs
        .iter()
        .map(|(key, ..)| *key)
        .filter(|key| !(tool && ORIENTATION.contains(&key.as_str())))
        .map(|key| format!("{key}=mm"))
        .collect();
    let list = |of: &dyn Fn(&(&String, &&String, &&String)) -> String| {
        shell_word(&pairs.iter().map(of).collect::<Vec<_>>().join(","))
    };
    (!pairs.is_empty()).then(|| {
        format!(
            "--planned {} --measured {}, with --slides {} if they are lengths of that unit, else with --degrees or --radians",
            list(&|(key, planned, _)| format!("{key}={planned}")),
            list(&|(key, _, measured)| format!("{key}={measured}")),
            shell_word(&slides.join(","))
        )
    })
}

/// The side that a name says, and what is left of it; `None` where it says none, or that it is of no joint for another reason.
fn of_column(name: &String) -> Option<(Role, String, &String)> {
    let words = words(name);
    let role = words
        .iter()
        .find_map(|word| if let Meaning::Role(role) = word.meaning { Some(role) } else { None })?;
    let velocity = Meaning::Quantity(Quantity::Velocity);
    let other = words.iter().any(|word| word.meaning == velocity || names_another_quantity(word.text));
    let left = words.iter().filter(|word| !matches!(word.meaning, Meaning::Role(_) | Meaning::Quantity(_)));
    let key = left.map(|word| word.text.to_lowercase()).collect::<Vec<_>>().join("_");
    (!key.is_empty() && !other && !name.contains([',', '='])).then_some((role, key, name))
}

/// Whether a word is of what is no position.
fn names_another_quantity(word: &str) -> bool {
    const OTHERS: &str = "acc accel acceleration jerk torque force current pressure temp temperature power";
    OTHERS.split(' ').any(|other| word.eq_ignore_ascii_case(other))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_that_differ_by_the_side_alone_are_offered_as_pairs() {
        let of = |names: &[&str]| offered(&names.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>());
        let found = of(&["time", "target_x", "target_y", "actual_x", "actual_y"]).unwrap();
        assert!(
            found.starts_with(
                "--planned x=target_x,y=target_y --measured x=actual_x,y=actual_y, with --slides x=mm,y=mm "
            ),
            "{found}"
        );
        assert!(of(&["X_RIst", "X_RSol"]).unwrap().contains("--planned x=X_RSol --measured x=X_RIst"));
        assert_eq!(of(&["step", "reference", "feedback", "err"]), None);
        assert_eq!(of(&["a", "b"]), None);
        let kinds = ["Position", "Velocity", "Acceleration"];
        let axes = ["Set", "Act"].map(|side| kinds.map(|kind| format!("X_{side}{kind}"))).concat();
        assert!(offered(&axes).unwrap().contains("--planned x=X_SetPosition --measured x=X_ActPosition"));
    }
}
