//! What a change did to the tracking error of a task.

mod figures;
mod page;
mod short;
mod steps;
mod tables;

pub(crate) use figures::figures;
pub(crate) use page::page;
pub(crate) use short::{at_the_tool, verdicts};
pub(crate) use tables::document;

use super::{kit::NONE, metric::Units};
use crate::{
    replay::Dimension,
    series::JointKind,
    workflow::compare::{Change, Comparison, Figures, Scope, Verdict},
};

/// Whether the joints of a scope turn or slide.
fn kind(comparison: &Comparison, scope: &Scope) -> JointKind {
    let scope = if *scope == Scope::Starts { &Scope::All } else { scope };
    let of = comparison.whole_run.iter().find(|figures| figures.scope == *scope);
    of.map_or(JointKind::Turns, |figures| figures.kind)
}

/// The figures of all joints together, or of each kind where they have no unit in common.
fn together(comparison: &Comparison) -> impl Iterator<Item = &Figures> {
    let of_kinds = [Scope::Turning, Scope::Sliding];
    let both = comparison.whole_run.iter().any(|figures| of_kinds.contains(&figures.scope));
    let is = move |scope: &Scope| if both { of_kinds.contains(scope) } else { *scope == Scope::All };
    comparison.whole_run.iter().filter(move |figures| is(&figures.scope))
}

fn together_name(scope: &Scope) -> &'static str {
    match scope {
        Scope::Turning => "joints that turn",
        Scope::Sliding => "joints that slide",
        _ => "all joints",
    }
}

fn scope(scope: &Scope) -> String {
    match scope {
        Scope::All => "all".to_owned(),
        Scope::Starts => "from rest".to_owned(),
        Scope::Turning => "turning".to_owned(),
        Scope::Sliding => "sliding".to_owned(),
        Scope::Joint(joint) => joint.clone(),
    }
}

/// `before -> after`; nothing where neither is known.
fn arrow(change: &Change, dimension: Dimension, kind: JointKind, units: Units) -> String {
    let show = |value| units.optional(dimension, kind, value);
    match (change.before, change.after) {
        (None, None) => NONE.to_owned(),
        (before, after) => format!("{} -> {}", show(before), show(after)),
    }
}

fn word(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Smaller => "smaller",
        Verdict::Larger => "larger",
        Verdict::Mixed => "mixed",
        Verdict::NotShown => "not shown",
        Verdict::Equal => "equal",
        Verdict::TooFew => "too few",
    }
}
