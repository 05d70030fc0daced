//! The same task by splines of other degrees, for people.

use super::rows::{plans, row};
use crate::{
    render::kit::{Id, Section, Sentence},
    workflow::plan::Planned,
};

/// What the other degrees give by the same rule, where it was asked for.
pub(super) fn degrees(compared: bool, planned: &Planned) -> Option<Section> {
    let own = planned.degree;
    let mut rows = vec![row(&format!("degree {own}, the task's"), &planned.chosen, &planned.joints)];
    let (mut said, mut best) = (Vec::new(), None);
    for other in &planned.degrees {
        let degree = other.degree;
        match &other.chosen {
            Some((plan, _)) => rows.push(row(&format!("degree {degree}"), plan, &planned.joints)),
            None => said.push(Sentence::finding(format!("No plan of degree {degree} was found."))),
        }
        if let Some(better) = other.better().filter(|better| best.is_none_or(|(_, most)| *better > most)) {
            best = Some((degree, better));
        }
    }
    said.push(Sentence::finding(match best {
        Some((degree, better)) => format!(
            "By the rule degree {degree} is better by {:.1} %: `degree = {degree}` in the task takes it. Its derivatives \
             are continuous up to that of order {}{}.",
            100.0 * better,
            degree - 1,
            if degree < 6 { " in motion; where it leaves rest and comes to it, its jerk steps" } else { "" }
        ),
        None => format!("By the rule no other degree is better than {own} by more than 1 %."),
    }));
    compared.then(|| Section::new(Id::OTHER, "The same by other degrees", [plans(rows)]).with_all(said))
}
