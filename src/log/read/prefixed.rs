//! Joints of plan and measurement that are called alike but for what stands before or after, such as `boom`,
//! `ex1/boom` and `ex1_boom_joint`.

use super::{
    candidates::{Candidate, candidates},
    content::{Content, Extracted},
    cylinders::Kinds,
};
use crate::{
    log::{error::LogError, last_part::pairs, options::ReadOptions, source::Role},
    remark::Code,
};

/// Calls measured joints as the plan does, where no name is common to both and each of one side pairs with exactly one
/// of the other; whether that was so.
pub(super) fn pair(
    extracted: &mut Extracted,
    options: &mut ReadOptions,
    kinds: &mut Kinds,
) -> Result<bool, LogError> {
    let planned = best(candidates(extracted, &options.planned, Role::Planned)?);
    let measured = best(candidates(extracted, &options.measured, Role::Measured)?);
    let Some(names) = pairs(&joints(&planned), &joints(&measured)) else { return Ok(false) };
    for source in measured.iter().map(|candidate| candidate.source) {
        let Content::Table(table) = &mut extracted.sources[source].content else { continue };
        for joint in &mut table.joints {
            if let Some(name) = names.get(joint) {
                kinds.call(source, name, std::mem::replace(joint, name.clone()));
            }
        }
    }
    let called = |joint: &mut String| names.get(joint).into_iter().for_each(|name| joint.clone_from(name));
    options.joints.iter_mut().for_each(called);
    let more = options.continuous.iter().filter_map(|joint| names.get(joint).cloned());
    options.continuous.extend(more.collect::<Vec<_>>());
    let told: Vec<String> = names.iter().map(|(came, plan)| format!("{plan} with {came}")).collect();
    let message = format!(
        "plan and measurement have no name of a joint in common; paired by the last part of their names: {}; other \
         topics are named with --planned and --measured",
        told.join(", ")
    );
    extracted.remarks.add(Code::Guessed, told.len() as u64, message);
    Ok(true)
}

/// Those that fit as well as the first.
fn best(mut all: Vec<Candidate>) -> Vec<Candidate> {
    let rank = all.first().map(|first| first.rank);
    all.retain(|candidate| Some(candidate.rank) == rank);
    all
}

fn joints(all: &[Candidate]) -> Vec<&str> {
    let mut names: Vec<&str> =
        all.iter().flat_map(|candidate| &candidate.joints).map(String::as_str).collect();
    names.sort_unstable();
    names.dedup();
    names
}
