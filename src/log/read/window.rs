//! Which chunks a stretch of a run takes, by the index of the file.

use std::collections::{BTreeMap, BTreeSet};

use super::{
    candidates::Candidate,
    content::{Extracted, Route},
};
use crate::{
    log::{
        error::LogError,
        file::Held,
        range::TimeRange,
        source::{Form, Spec},
    },
    units::NS_PER_S,
};

/// Messages are received this much earlier or later than their stamps say, against the first one, at most.
const MARGIN_NS: i64 = 2_000_000_000;

/// Which chunks to read.
pub(super) struct Window {
    /// When the recorder received what belongs to the stretch.
    log_ns: [i64; 2],
    /// The chunk of each source that begins it, which tells when the run began: file and number.
    firsts: BTreeSet<(usize, usize)>,
}

impl Window {
    /// Of the chunks of all files, by what is read of each; `None` where nothing is cut off.
    pub(super) fn of<'a>(
        range: TimeRange,
        chunks: impl Iterator<Item = ((usize, usize), &'a [Held], &'a BTreeMap<u16, Route>)>,
        specs: &[Spec],
        named: &impl Fn(&Route) -> bool,
    ) -> Option<Self> {
        let mut begins: BTreeMap<usize, (u64, (usize, usize))> = BTreeMap::new();
        if range.cuts() {
            for (place, held, routes) in chunks {
                for one in held {
                    let Some(route) = routes.get(&one.channel) else { continue };
                    let Some((source, _)) = route.read.as_ref().filter(|_| named(route)) else { continue };
                    let known = begins.entry(*source).or_insert((u64::MAX, place));
                    *known = (*known).min((one.log_ns[0], place));
                }
            }
        }
        let instants = begins.iter().filter(|(source, _)| !stands(&specs[**source]));
        let instants = instants.map(|(_, (ns, _))| i64::try_from(*ns).unwrap_or(i64::MAX));
        let begins_ns = [instants.clone().min()?, instants.max()?];
        let firsts = begins.into_values().map(|(_, place)| place).collect();
        Some(Self { log_ns: range.around(begins_ns, MARGIN_NS), firsts })
    }

    /// Whether messages of a channel in a chunk are to be read: those of the stretch, those that begin the run, and what
    /// holds beyond its own time.
    pub(super) fn takes(&self, place: (usize, usize), one: &Held, route: &Route, specs: &[Spec]) -> bool {
        let [first_ns, last_ns] = one.log_ns.map(|ns| i64::try_from(ns).unwrap_or(i64::MAX));
        let Some((source, _)) = &route.read else { return route.describes };
        let holds_on = stands(&specs[*source]);
        self.firsts.contains(&place) || first_ns <= self.log_ns[1] && (holds_on || last_ns >= self.log_ns[0])
    }
}

/// Whether a message of a source may be of what comes long after it.
fn stands(spec: &Spec) -> bool {
    matches!(spec.form, Form::Plans | Form::VersionedNames)
}

/// Whether a topic may be of the run: all are, unless the caller named those of both sides.
pub(super) fn may_be_of_run(out: &Extracted, named: Option<&[&str]>, route: &Route) -> bool {
    named.is_none_or(|named| named.contains(&out.topics[route.topic].topic.as_str()))
}

/// Says what the chosen topics span, in place of the range that has none of their samples.
pub(super) fn nothing_in(range: TimeRange, extracted: &Extracted, chosen: &[Candidate]) -> LogError {
    let topics = chosen.iter().map(|c| extracted.topic_of(c.source));
    let begins_ns = topics.clone().map(|topic| topic.first_log_ns).min().unwrap_or(0);
    let ends_ns = topics.clone().map(|topic| topic.last_log_ns).max().unwrap_or(0);
    LogError::NothingInRange {
        topic: topics.map(|topic| topic.topic.as_str()).collect::<Vec<_>>().join(", "),
        range: range.words(),
        spans_s: ends_ns.saturating_sub(begins_ns) as f64 / NS_PER_S,
    }
}
