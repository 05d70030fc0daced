//! Names of joints that differ only by what stands before or after: `boom`, `ex1/boom` and `ex1_boom_joint`.

use std::collections::BTreeMap;

/// A word that says nothing of which joint it is.
const JOINT: &str = "joint";

/// The planned name of each measured joint; `None` unless each of the shorter list pairs with one, and only that with it.
pub(super) fn pairs(planned: &[&str], measured: &[&str]) -> Option<BTreeMap<String, String>> {
    let [plan, came] =
        [planned, measured].map(|names| names.iter().map(|name| words(name)).collect::<Vec<_>>());
    let mut names = BTreeMap::new();
    for (k, plan) in plan.iter().enumerate() {
        let alike: Vec<usize> = (0..came.len()).filter(|m| ends_alike(plan, &came[*m])).collect();
        let one = match alike[..] {
            [] => continue,
            [one] => one,
            _ => return None,
        };
        if names.insert(measured[one].to_owned(), planned[k].to_owned()).is_some() {
            return None;
        }
    }
    (!names.is_empty() && names.len() == planned.len().min(measured.len())).then_some(names)
}

/// Whether two names may be of one joint.
pub(super) fn alike(a: &str, b: &str) -> bool {
    ends_alike(&words(a), &words(b))
}

fn words(name: &str) -> Vec<String> {
    let words = name.split(['/', '_', '-', '.', ':']).filter(|word| !word.is_empty());
    words.map(str::to_ascii_lowercase).filter(|word| word != JOINT).collect()
}

fn ends_alike(a: &[String], b: &[String]) -> bool {
    !a.is_empty() && !b.is_empty() && (a.ends_with(b) || b.ends_with(a))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_pair_by_their_last_part_if_each_has_one_partner() {
        let found = |planned: &[&str], measured: &[&str]| {
            pairs(planned, measured).map(|names| names.into_iter().collect::<Vec<_>>())
        };
        let two =
            |a: [&str; 2], b: [&str; 2]| Some(vec![(a[0].into(), a[1].into()), (b[0].into(), b[1].into())]);
        assert_eq!(
            found(&["boom", "stick"], &["ex1/boom", "ex1/stick"]),
            two(["ex1/boom", "boom"], ["ex1/stick", "stick"])
        );
        assert_eq!(
            found(&["a/Boom", "a/stick"], &["boom", "grip", "stick_joint"]),
            two(["boom", "a/Boom"], ["stick_joint", "a/stick"])
        );
        assert_eq!(
            found(&["joint_1", "joint_2"], &["ex1_joint_1", "ex1_joint_2"]),
            two(["ex1_joint_1", "joint_1"], ["ex1_joint_2", "joint_2"])
        );
        // Which of two is meant, one without a partner on either side, parts of words, and names that are no words.
        for [planned, measured] in [
            [&["boom"][..], &["left/boom", "right/boom"]],
            [&["left/boom", "right/boom"], &["boom"]],
            [&["boom", "tilt"], &["ex1/boom", "ex1/grip"]],
            [&["arm"], &["forearm"]],
            [&["joint"], &["ex1/joint"]],
            [&[], &["boom"]],
        ] {
            assert_eq!(found(planned, measured), None, "{planned:?} {measured:?}");
        }
    }
}
