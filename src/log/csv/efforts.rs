//! Leaves out commands that are no positions: of a controller of valves or torques.

use std::borrow::Cow;

use super::{
    Quantity, Role,
    head::Head,
    layout::{Layout, Use},
    read::Cells,
};
use crate::remark::{Code, Remarks};

/// A command that reaches so many times as far as the plan of its joint is none of positions.
const TIMES: f64 = 20.0;

/// The layout without columns of commands that reach much farther than their joint's plan, unless `stated`.
pub(super) fn left_out<'a>(
    layout: &'a Layout,
    head: &Head,
    cells: &Cells,
    stated: impl Fn(usize) -> bool,
    remarks: &mut Remarks,
) -> Cow<'a, Layout> {
    let reach = |one: &Use| cells.columns.get(&one.column).map_or(0.0, super::read::Column::reach);
    let of = |role: Role, joint: usize| {
        let is =
            move |one: &&Use| one.joint == joint && one.role == role && one.quantity == Quantity::Position;
        layout.uses.iter().find(is)
    };
    let odd = |one: &&Use| {
        let position = one.role == Role::Command && one.quantity == Quantity::Position;
        let plan = of(Role::Planned, one.joint).filter(|_| of(Role::Measured, one.joint).is_some());
        position && !stated(one.column) && plan.is_some_and(|plan| reach(one) > TIMES * reach(plan).max(0.1))
    };
    let found: Vec<Use> = layout.uses.iter().filter(odd).cloned().collect();
    for one in &found {
        let message = format!(
            "column {:?} reaches {:.0}, much farther than the plan of {}: taken as no position and left out; \
             --command {}=COLUMN keeps it",
            head.names[one.column],
            reach(one),
            layout.joints[one.joint],
            layout.joints[one.joint]
        );
        remarks.add(Code::Guessed, 1, message);
    }
    if found.is_empty() {
        return Cow::Borrowed(layout);
    }
    let uses = layout.uses.iter().filter(|one| !found.contains(one)).cloned().collect();
    Cow::Owned(Layout { uses, ..layout.clone() })
}
