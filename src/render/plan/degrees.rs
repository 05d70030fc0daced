//! The same task by splines of other degrees, for people.

use super::rows::{plans, row};
use crate::{
    render::kit::{Id, Section, Sentence},
    workflow::plan::Planned,
};

/// What the other degrees give by the same rule, where it was asked for.
pub(super) fn degrees(compared: bool, planned: &Planned) -> Option<Section> {
    let own = planned.degree;
    let first = row(&format!("degree {own}, the task's"), &planned.chosen, &planned.joints);
    let others = planned.degrees.iter();
    let rows =
        others.clone().map(|other| row(&format!("degree {}", other.degree), &other.chosen, &planned.joints));
    let best = others.clone().filter(|other| other.is_better()).max_by(|a, b| a.better.total_cmp(&b.better));
    let said = match best {
        Some(other) => Sentence::finding(format!(
            "By the rule degree {} is better by {:.1} %: `degree = {}` in the task takes it. Its derivatives are \
             continuous up to that of order {}.",
            other.degree,
            100.0 * other.better,
            other.degree,
            other.degree - 1
        )),
        None => {
            Sentence::finding(format!("By the rule no other degree is better than {own} by more than 1 %."))
        }
    };
    compared.then(|| {
        Section::new(Id::OTHER, "The same by other degrees", [plans(std::iter::once(first).chain(rows))])
            .with(said)
    })
}
