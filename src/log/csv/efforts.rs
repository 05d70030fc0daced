//! Commands that are no positions: signals to valves are kept as such, others left out.

use std::collections::BTreeSet;

use super::{
    Quantity, Role,
    head::Head,
    label::Label,
    layout::{Interface, Layout, Use, one_side},
    read::Cells,
    signals::{Goes, is_elsewhere, moves_the_speed},
};
use crate::{
    log::write::VALVE,
    remark::{Code, Remarks},
};

/// A command that reaches so many times as far as the plan of its joint is none of positions.
const TIMES: f64 = 20.0;

/// The layout with commands as signals to the valves, where those of half of the joints or more move the speed of their
/// joints, unless `stated`.
pub(super) fn as_signals(
    mut layout: Layout,
    head: &Head,
    labels: &[Label],
    cells: &Cells,
    stated: impl Fn(usize) -> bool,
    remarks: &mut Remarks,
) -> Layout {
    let values = |column: usize| cells.columns.get(&column).map(|column| column.values.as_slice());
    let position = |one: &&Use, role: Role| one.role == role && one.quantity == Quantity::Position;
    let of =
        |joint: usize, role: Role| layout.uses.iter().find(|one| one.joint == joint && position(one, role));
    let both = |one: &Use| Some((values(one.column)?, values(of(one.joint, Role::Measured)?.column)?));
    let sent: Vec<&Use> = layout.uses.iter().filter(|one| position(one, Role::Command)).collect();
    let goes = |one: &&Use| {
        let (sent, came) = both(one)?;
        Some((one.column, moves_the_speed(&cells.stamp_ns, sent, came)?))
    };
    let found: Vec<(usize, Goes)> = sent.iter().filter_map(goes).collect();
    let clearest = found.iter().max_by(|a, b| a.1.speed.abs().total_cmp(&b.1.speed.abs()));
    let is_free =
        sent.iter().all(|one| !stated(one.column)) && layout.interfaces.iter().all(|one| one.name != VALVE);
    let elsewhere = |one: &&Use| {
        let (sent, came) = both(one)?;
        Some((one.column, is_elsewhere(sent, came)?))
    };
    let apart: Vec<(usize, f64)> = sent.iter().filter_map(elsewhere).collect();
    let what = match clearest.filter(|_| is_free && 2 * found.len() >= sent.len()) {
        Some((column, goes)) => format!(
            "{:?}: the speed of their joints goes with them (correlation {:.2}), and the position does not ({:.2})",
            head.names[*column], goes.speed, goes.position
        ),
        None => match apart.first().filter(|_| is_free && 2 * apart.len() >= sent.len()) {
            Some((column, travel)) => format!(
                "{:?}: they hardly change while their joints travel {travel:.1}, nowhere near them",
                head.names[*column]
            ),
            None => return layout,
        },
    };
    let message = format!(
        "columns such as {what}; taken as signals to the valves, or as set speeds, and not as what a position is held against; --command \
         JOINT=COLUMN,... takes them as set positions"
    );
    remarks.add(Code::Guessed, sent.len() as u64, message);
    let signals =
        sent.iter().map(|one| Interface { name: VALVE.to_owned(), column: one.column, joint: one.joint });
    layout.interfaces.extend(signals.collect::<Vec<_>>());
    layout.uses.retain(|one| one.role != Role::Command);
    if layout.uses.iter().all(|one| one.role != Role::Planned) {
        *remarks = std::mem::take(remarks).without(Code::PlanIsCommand);
        let names: Vec<&str> = layout.joints.iter().map(String::as_str).collect();
        remarks.add(Code::OneSide, names.len() as u64, one_side(&names, labels, "plan", "--planned"));
    }
    layout
}

/// The layout in which commands are the plans of joints that have none where others have one: a report would leave such joints out.
pub(super) fn as_plans(mut layout: Layout, head: &Head, remarks: &mut Remarks) -> Layout {
    let joints_of = |role: Role| {
        let of_role =
            layout.uses.iter().filter(move |one| one.role == role && one.quantity == Quantity::Position);
        of_role.map(|one| one.joint).collect::<BTreeSet<usize>>()
    };
    let [planned, measured, sent] = [Role::Planned, Role::Measured, Role::Command].map(joints_of);
    let stands_in: BTreeSet<usize> = &(&sent & &measured) - &planned;
    if planned.is_empty() || stands_in.is_empty() {
        return layout;
    }
    for one in
        layout.uses.iter_mut().filter(|one| one.role == Role::Command && stands_in.contains(&one.joint))
    {
        one.role = Role::Planned;
    }
    let of = |one: &&Use| one.role == Role::Planned && stands_in.contains(&one.joint);
    if let Some(one) = layout.uses.iter().find(of) {
        let message = format!(
            "joints without a plan, where others have one, such as {}: a report holds them against what was sent ({:?}); \
             --planned JOINT=COLUMN,... names their plans",
            layout.joints[one.joint], head.names[one.column]
        );
        remarks.add(Code::PlanIsCommand, stands_in.len() as u64, message);
    }
    layout
}

/// The layout without columns of commands that reach much farther than their joint's plan, unless `stated`.
pub(super) fn left_out(
    mut layout: Layout,
    head: &Head,
    cells: &Cells,
    stated: impl Fn(usize) -> bool,
    remarks: &mut Remarks,
) -> Layout {
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
    layout.uses.retain(|one| !found.contains(one));
    layout
}
