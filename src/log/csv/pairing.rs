//! What only the columns together tell: which of two is the plan, and which words of their names are of no joint.

use std::collections::BTreeSet;

use super::{Quantity, Role, head::Head};
use crate::remark::{Code, Remarks};

/// What a column seems to be.
#[derive(Debug, Clone)]
pub(super) struct Draft {
    pub(super) column: usize,
    pub(super) role: Role,
    pub(super) quantity: Quantity,
    pub(super) key: String,
    pub(super) joint: String,
    /// Whether the caller or a word of the header says the role.
    pub(super) stated: bool,
}

/// A column that says neither plan nor measurement, beside a measured one of the same joint, is the plan where nothing
/// else is: `Boom.Position` beside `Boom.ActualPosition`.
pub(super) fn plan_beside_measured(head: &Head, drafts: &mut [Draft], remarks: &mut Remarks) {
    let mut found = Vec::new();
    for (at, bare) in drafts.iter().enumerate().filter(|(_, draft)| !draft.stated) {
        let same = |other: &&Draft| other.key == bare.key && other.quantity == bare.quantity;
        let mut others = drafts.iter().enumerate().filter(|(index, other)| *index != at && same(other));
        let measured = others.next().filter(|(_, other)| other.stated && other.role == Role::Measured);
        let Some((_, measured)) = measured.filter(|_| others.next().is_none()) else { continue };
        if head.sample.iter().any(|row| row.get(bare.column) != row.get(measured.column)) {
            found.push((at, measured.column));
        }
    }
    if let Some((bare, measured)) = found.first() {
        let message = format!(
            "columns such as {:?}, taken as the plan because {:?} stands beside; else say --planned JOINT=COLUMN,...",
            head.names[drafts[*bare].column], head.names[*measured]
        );
        remarks.add(Code::Guessed, found.len() as u64, message);
    }
    for (at, _) in found {
        (drafts[at].role, drafts[at].stated) = (Role::Planned, true);
    }
}

/// Where no joint has plan and measurement, words that all columns of a side share are of that side, not of a joint:
/// `Boom S-0-0047 value`, `Boom S-0-0051 value 1`.
pub(super) fn without_shared_words(drafts: &mut [Draft]) {
    // A command counts as the plan's, as in the names of its columns.
    let of_plan = |draft: &Draft| draft.role != Role::Measured;
    let positions = |plan: bool| {
        let wanted = move |draft: &&Draft| draft.quantity == Quantity::Position && of_plan(draft) == plan;
        drafts.iter().filter(wanted).map(|draft| draft.key.as_str())
    };
    let [plan, measured] = [true, false].map(|plan| positions(plan).collect::<Vec<_>>());
    let paired = plan.iter().any(|key| measured.contains(key));
    if plan.len() < 2 || measured.len() < 2 || paired {
        return;
    }
    let shared = [&measured, &plan].map(|keys| shared_parts(keys));
    let short = |name: &str, plan: bool| {
        let own = |part: &&str| !shared[usize::from(plan)].contains(&part.to_lowercase());
        let left = name.split('_').filter(own).collect::<Vec<_>>().join("_");
        let counts = !left.is_empty() && left.bytes().all(|byte| byte.is_ascii_digit());
        if counts { format!("joint_{left}") } else { left }
    };
    let names = |keys: &[&str], plan: bool| keys.iter().map(|key| short(key, plan)).collect::<BTreeSet<_>>();
    let [plan_names, measured_names] = [names(&plan, true), names(&measured, false)];
    let distinct = plan_names.len() == plan.len() && measured_names.len() == measured.len();
    if distinct && plan_names.is_subset(&measured_names) && !measured_names.contains("") {
        let renamed: Vec<[String; 2]> = drafts
            .iter()
            .map(|draft| [&draft.key, &draft.joint].map(|name| short(name, of_plan(draft))))
            .collect();
        for (draft, [key, joint]) in drafts.iter_mut().zip(renamed) {
            (draft.key, draft.joint) = (key, joint);
        }
    }
}

/// Parts between underscores that all names have.
fn shared_parts(names: &[&str]) -> BTreeSet<String> {
    let parts = |name: &&str| name.split('_').map(str::to_lowercase).collect::<BTreeSet<_>>();
    let shared = names.iter().map(parts).reduce(|shared, parts| &shared & &parts);
    shared.unwrap_or_default()
}
