//! Which number of a topic without names is which joint of the other side: the one that moves like it.

use std::collections::BTreeSet;

use super::{
    alike::{Alike, both},
    candidates::Candidate,
    content::{Content, Extracted},
};
use crate::{
    log::options::TimeBase,
    series::{JointKind, Track},
    units::NS_PER_S,
};

/// A joint moves like its number if they correlate so.
const LIKE: f64 = 0.8;

/// The names of joints in the order of the numbers of a topic; `None` unless each number moves like a joint of its own.
pub(super) fn named_in_order(
    extracted: &Extracted,
    numbers: &Candidate,
    named: &[Candidate],
) -> Option<Vec<String>> {
    let joints: Vec<Track> = named.iter().filter_map(|one| tracks(extracted, one)).flatten().collect();
    let like = |number: &Track| -> Option<String> {
        let of = |joint: &Track| Alike::of(&both(number, joint)).map_or(0.0, |found| found.correlation);
        let best = joints.iter().max_by(|a, b| of(a).total_cmp(&of(b)))?;
        (of(best) > LIKE).then(|| best.name().to_owned())
    };
    let names: Vec<String> = tracks(extracted, numbers)?.iter().map(like).collect::<Option<_>>()?;
    let distinct = names.iter().collect::<BTreeSet<_>>().len() == names.len();
    distinct.then_some(names)
}

/// The joints of a candidate by the recorder's clock.
fn tracks(extracted: &Extracted, candidate: &Candidate) -> Option<Vec<Track>> {
    let Content::Table(table) = &extracted.sources[candidate.source].content else { return None };
    let first_ns = i64::try_from(extracted.topics.iter().map(|topic| topic.first_log_ns).min()?).ok()?;
    let track = |name: &String| {
        let joint = table.joints.iter().position(|one| one == name)?;
        let (mut t_s, mut position): (Vec<f64>, Vec<f64>) = (Vec::new(), Vec::new());
        for (ns, q) in table.stamps.of(TimeBase::Log).iter().zip(table.column(candidate.field?, joint)) {
            let at_s = ns.saturating_sub(first_ns) as f64 / NS_PER_S;
            if q.is_finite() && t_s.last().is_none_or(|last| *last < at_s) {
                t_s.push(at_s);
                position.push(*q);
            }
        }
        Track::of(JointKind::Turns, name.as_str(), t_s, position, &[]).ok()
    };
    candidate.joints.iter().map(track).collect()
}
