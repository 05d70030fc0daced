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
    let planned = |draft: &Draft| draft.role != Role::Measured;
    let keys = |drafts: &[Draft], side: bool| -> Vec<String> {
        let of = drafts.iter().filter(|one| one.quantity == Quantity::Position && planned(one) == side);
        of.map(|one| one.key.clone()).collect()
    };
    let [before, came] = [true, false].map(|side| keys(drafts, side));
    if before.len() < 2 || came.len() < 2 || before.iter().any(|key| came.contains(key)) {
        return;
    }
    let shared = [&before, &came].map(|keys| {
        let mut words = keys.iter().map(|key| words(key));
        let first = words.next().unwrap_or_default();
        words.fold(first, |shared, words| shared.intersection(&words).cloned().collect())
    });
    let short: Vec<(String, String)> = drafts
        .iter()
        .map(|one| {
            let shared = &shared[usize::from(!planned(one))];
            let name = |text: &str| {
                let parts = text.split('_').filter(|part| !shared.contains(&part.to_lowercase()));
                parts.collect::<Vec<_>>().join("_")
            };
            (name(&one.key), name(&one.joint))
        })
        .collect();
    let of = |side: bool| {
        let keys = drafts
            .iter()
            .zip(&short)
            .filter(|(one, _)| one.quantity == Quantity::Position && planned(one) == side);
        keys.map(|(_, (key, _))| key.as_str()).collect::<Vec<_>>()
    };
    let [before, came] = [of(true), of(false)];
    let distinct = |keys: &[&str]| keys.iter().collect::<BTreeSet<_>>().len() == keys.len();
    let named = short.iter().all(|(key, _)| !key.is_empty());
    if named && distinct(&before) && distinct(&came) && before.iter().all(|key| came.contains(key)) {
        for (draft, (key, joint)) in drafts.iter_mut().zip(short) {
            (draft.key, draft.joint) = (key, joint);
        }
    }
}

fn words(key: &str) -> BTreeSet<String> {
    key.split('_').map(str::to_lowercase).collect()
}
