//! Remarks on what was chosen.

use std::collections::BTreeMap;

use super::{origin::Imported, select_topics::Choice};
use crate::{
    log::options::ReadOptions,
    remark::{Code, Remarks},
};

/// Remarks on the choice; returns whether the plan is a command.
pub(super) fn remark_choice(
    choice: &Choice,
    options: &ReadOptions,
    tables: &[BTreeMap<String, String>],
    remarks: &mut Remarks,
) -> bool {
    for rival in &choice.rivals {
        let message = format!("{rival} measures the same joints and was not used; choose with --measured");
        remarks.add(Code::Ambiguous, 1, message);
    }
    for (code, message) in &choice.doubts {
        remarks.add(*code, 1, message.as_str());
    }
    let commanded: Vec<&str> =
        if options.planned.is_empty() { choice.commanded().collect() } else { Vec::new() };
    // A table that is read as it is was doubted column by column.
    let told = remarks.as_slice().iter().any(|remark| remark.code == Code::PlanIsCommand);
    if let ([first, ..], false) = (commanded.as_slice(), told) {
        let (sent, fix) = match Imported::of(tables) {
            Some(table) => (
                format!("the command in {}", table.file),
                "or import its columns with --planned JOINT=COLUMN,...",
            ),
            None => ((*first).to_owned(), "--planned TOPIC names it"),
        };
        let message = format!(
            "{sent} is what was sent, and nothing in the log looks like the plan behind it: the error is against \
             the command, not against what was wanted; `hydrotrace join LOG --plan next.mcap -o with-plan.mcap` puts the plan into \
             the log, {fix}"
        );
        remarks.add(Code::PlanIsCommand, commanded.len() as u64, message);
    }
    !commanded.is_empty()
}
