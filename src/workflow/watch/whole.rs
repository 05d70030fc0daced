//! When a log is whole. What is still being written is looked at again; nothing tells when it ends but its own bytes
//! and its rest.

use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
    time::{Duration, Instant, SystemTime},
};

use crate::{
    log::{Ending, ending, recording_files},
    remark::Remarks,
    workflow::fleet::Source,
};

/// How long a log without an end must have rested: its recorder was killed.
const LEFT: Duration = Duration::from_secs(60);

/// How long a log has been as it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Rest {
    /// Since it was first seen so, by this process.
    seen: Duration,
    /// Since it changed, by the clocks of two computers, which may disagree.
    said: Duration,
}

/// Whether a log is whole. A closed one need only be left alone; of any other the rest must have been seen, so that a
/// clock that is wrong makes no log whole that is still being written.
fn is_whole(ending: Ending, rest: Rest, settle: Duration) -> bool {
    let longest = rest.seen.max(rest.said);
    match ending {
        Ending::Closed => longest >= settle,
        Ending::Untold => rest.seen >= settle,
        Ending::Open => rest.seen >= settle && longest >= settle.max(LEFT),
    }
}

/// The state in which a log was seen, and since when.
#[derive(Debug)]
struct State {
    etag: String,
    since: Instant,
    /// Its rows and its page are there.
    done: bool,
    /// It could not be read, which may pass.
    failed: bool,
}

/// All logs that were seen.
#[derive(Debug, Default)]
pub(super) struct Logs {
    states: BTreeMap<PathBuf, State>,
}

impl Logs {
    /// Takes note of what is there; returns the logs that are whole and not done, and how many are not whole.
    pub(super) fn look(&mut self, found: Vec<Source>, settle: Duration) -> (Vec<Source>, usize) {
        let (now, clock) = (Instant::now(), SystemTime::now());
        self.states.retain(|path, _| found.binary_search_by(|source| source.path.cmp(path)).is_ok());
        for Source { path, etag, .. } in &found {
            let known = self.states.get(path).is_some_and(|state| state.etag == *etag);
            if !known {
                let state = State { etag: etag.clone(), since: now, done: false, failed: false };
                self.states.insert(path.clone(), state);
            }
        }
        // The parts of a bag that is not described yet rest together: a recorder goes on to the next one.
        let mut bags: BTreeMap<PathBuf, Rest> = BTreeMap::new();
        let mut open = Vec::new();
        for source in found {
            let Some(state) = self.states.get(&source.path).filter(|state| !state.done) else { continue };
            let rest = Rest { seen: now.duration_since(state.since), said: age(&source.path, clock) };
            let bag = bag_of_part(&source.path);
            if let Some(bag) = &bag {
                let least = bags.entry(bag.clone()).or_insert(rest);
                *least = Rest { seen: least.seen.min(rest.seen), said: least.said.min(rest.said) };
            }
            open.push((source, rest, bag, state.failed));
        }
        let all = open.len();
        let whole = open.into_iter().filter_map(|(source, rest, bag, failed)| {
            let (ending, rest) = match bag.and_then(|bag| bags.get(&bag)) {
                Some(rest) => (Ending::Open, *rest),
                // Again after as long as a killed recorder is given.
                None if failed => (Ending::Open, Rest { said: rest.seen, ..rest }),
                // A store shows an object when all of it is there.
                None if source.is_remote() => (Ending::Closed, Rest { said: Duration::MAX, ..rest }),
                None => (ending_of(&source.path), rest),
            };
            is_whole(ending, rest, settle).then_some(source)
        });
        let whole: Vec<Source> = whole.collect();
        let waiting = all - whole.len();
        (whole, waiting)
    }

    /// A log was analysed in this state; `failed`: in vain, for a reason that may pass.
    pub(super) fn note(&mut self, path: &Path, etag: &str, failed: bool) {
        if let Some(state) = self.states.get_mut(path).filter(|state| state.etag == etag) {
            state.done = !failed;
            state.failed = failed;
            state.since = Instant::now();
        }
    }
}

/// The files of a log: of a bag those that hold its messages.
fn files(path: &Path) -> Vec<PathBuf> {
    recording_files(&[path.to_owned()], &mut Remarks::default()).unwrap_or_default()
}

/// How long ago the youngest of its files changed; none in a store.
fn age(path: &Path, clock: SystemTime) -> Duration {
    let changed = |path: PathBuf| fs::metadata(path).and_then(|is| is.modified()).ok();
    let youngest = files(path).into_iter().filter_map(changed).max();
    youngest.and_then(|at| clock.duration_since(at).ok()).unwrap_or_default()
}

/// The least closed of its files. What cannot be read now is tried by whoever reads it.
fn ending_of(path: &Path) -> Ending {
    let of = |path: PathBuf| ending(&path).unwrap_or(Ending::Untold);
    files(path).into_iter().map(of).max().unwrap_or(Ending::Untold)
}

/// The folder of a bag that its recorder has not described yet, of one of its parts: `run/run_0.mcap`.
fn bag_of_part(path: &Path) -> Option<PathBuf> {
    let folder = path.parent()?;
    let rest = path.file_name()?.to_str()?.strip_prefix(folder.file_name()?.to_str()?)?.strip_prefix('_')?;
    let (number, _) = rest.split_once('.')?;
    (!number.is_empty() && number.bytes().all(|byte| byte.is_ascii_digit())).then(|| folder.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_closed_log_is_whole_at_once_and_one_without_an_end_when_it_was_left() {
        let settle = Duration::from_secs(3);
        for (ending, seen_s, said_s, whole) in [
            (Ending::Closed, 0, 0, false),
            (Ending::Closed, 3, 0, true),
            // It was there before this process.
            (Ending::Closed, 0, 100, true),
            (Ending::Untold, 0, 100, false),
            (Ending::Untold, 3, 0, true),
            (Ending::Open, 59, 0, false),
            (Ending::Open, 60, 0, true),
            // A clock that is wrong by a minute while the recorder writes each second.
            (Ending::Open, 1, 100, false),
            (Ending::Open, 3, 100, true),
        ] {
            let [seen, said] = [seen_s, said_s].map(Duration::from_secs);
            assert_eq!(is_whole(ending, Rest { seen, said }, settle), whole, "{ending:?} {seen_s} {said_s}");
        }
        let rest = Rest { seen: Duration::from_secs(70), said: Duration::ZERO };
        assert!(!is_whole(Ending::Open, rest, Duration::from_secs(80)));
    }

    #[test]
    fn a_part_of_a_bag_waits_for_its_description() {
        let of = |path: &str| bag_of_part(Path::new(path)).map(|folder| folder.display().to_string());
        assert_eq!(of("/logs/run/run_0.mcap").as_deref(), Some("/logs/run"));
        assert_eq!(of("/logs/run/run_12.db3").as_deref(), Some("/logs/run"));
        for other in
            ["/logs/run/run_0", "/logs/run/other_0.mcap", "/logs/run/run_a.mcap", "/logs/run/run.mcap", "/"]
        {
            assert_eq!(of(other), None, "{other}");
        }
    }
}
