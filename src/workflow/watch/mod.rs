//! `watch`: reports each log of a folder when it is whole: a page a run, an index of all, and the rows of a fleet.
//!
//! Folders are looked at again and again, which works on shares too. Nothing that is written tells when it was, nor in
//! which order logs appeared.

mod document;
mod failure;
mod folder;
mod whole;

use std::{
    ops::ControlFlow,
    path::{Path, PathBuf},
    sync::{Mutex, PoisonError},
    thread,
    time::{Duration, Instant},
};

pub use document::{Run, RunJoint, Verdict};
pub use failure::WatchFailure;
use folder::{Folder, remove_page, write_page, write_run};

use super::{
    fleet::{
        self, Analysed, Beside, Drift, FleetFailure, Log, Source, compact, own_analysis_id, scan_these,
        sources_now,
    },
    report::{Gates, Report, hash},
};
use crate::{document::explained, remark::Remarks};
use whole::Logs;

/// Logs between two states of the dataset.
const BATCH: usize = 16;
/// Between two states of the index while many logs wait.
const INDEX_EVERY: Duration = Duration::from_secs(10);
/// Logs that were reported between two tidyings of the dataset, whose parts are as many.
const COMPACT_EVERY: usize = 128;
/// How soon an end that is asked for is noticed.
const MOMENT: Duration = Duration::from_millis(50);

/// What to watch, and how.
#[derive(Debug, Clone, Default)]
pub struct Inputs {
    /// Sources, the folder of the dataset, machines, and how logs are read.
    pub fleet: fleet::Inputs,
    /// Limits that make the verdicts.
    pub gates: Gates,
    /// Between two looks.
    pub every: Duration,
    /// How long a log must have rested.
    pub settle: Duration,
    /// Whether to end when all logs that are whole now are reported.
    pub once: bool,
}

/// The page of a run.
pub type Page<'a> = dyn Fn(&Report) -> String + Sync + 'a;

/// How findings are worded.
pub struct Words<'a> {
    /// The page of a run.
    pub page: &'a Page<'a>,
    /// The index.
    pub index: &'a dyn Fn(&Index<'_>) -> String,
}

/// All that was reported into a folder.
#[derive(Debug)]
pub struct Index<'a> {
    /// The newest first; those that failed last.
    pub runs: Vec<&'a Run>,
    /// What changes over the days; `None` before the first run.
    pub drift: Option<Drift>,
}

/// What a caller is told meanwhile.
#[derive(Debug)]
pub enum Event<'a> {
    /// A log was reported.
    Reported(&'a Run),
    /// Nothing is to be done: logs reported so far, and logs that are not whole yet.
    Waiting {
        /// Reported, by this process or before.
        reported: usize,
        /// Not whole, or to be tried again.
        open: usize,
    },
    /// Sources cannot be looked at now, and why.
    Trouble(&'a str),
}

/// What a watch did.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Watched {
    /// Where the index is.
    pub index: PathBuf,
    /// Logs that were reported.
    pub reported: usize,
    /// Runs among them that do not keep a limit.
    pub not_kept: usize,
    /// Runs among them with remarks on their data.
    pub doubtful: usize,
    /// Logs that were not whole at the end, or are to be tried again.
    pub open: usize,
    /// Doubts about the logs as a whole.
    pub remarks: Remarks,
}

/// Watches until `ended` says so; `tell` hears of each log.
///
/// # Errors
///
/// [`WatchFailure`] if a source leads nowhere, or if the dataset or a page cannot be written; a log that cannot be analysed
/// is a run with its error.
pub fn run(
    inputs: &Inputs,
    words: &Words<'_>,
    ended: &(dyn Fn() -> bool + Sync),
    tell: &mut dyn FnMut(Event<'_>),
) -> Result<Watched, WatchFailure> {
    let real = |path: &Path| path.canonicalize().ok();
    let same = |source: &String| {
        real(Path::new(source)).is_some_and(|source| real(&inputs.fleet.into) == Some(source))
    };
    if inputs.fleet.sources.iter().any(same) {
        return Err(WatchFailure::Itself { path: inputs.fleet.into.clone() });
    }
    let into = std::path::absolute(&inputs.fleet.into).unwrap_or_else(|_| inputs.fleet.into.clone());
    let found = |sources: &[String]| {
        let mut found = sources_now(sources)?;
        // What was made of logs is none.
        found.retain(|source| !source.path.starts_with(&into));
        Ok::<_, FleetFailure>(found)
    };
    // A source that leads nowhere is a mistake at first, and later a share that is away.
    let mut there = Ok(found(&inputs.fleet.sources)?);
    let mut watch = Watch {
        inputs,
        words,
        request_id: hash([own_analysis_id(&inputs.fleet), format!("{:?}", inputs.gates)]),
        folder: Folder::open(&inputs.fleet.into)?,
        done: Watched { index: Folder::index(&inputs.fleet.into), ..Watched::default() },
    };
    let (mut logs, mut begun, mut trouble) = (Logs::default(), None, None);
    watch.folder.write_index(words)?;
    loop {
        let look = Instant::now();
        let open = match there {
            Ok(found) => {
                trouble = None;
                let (whole, open) = logs.look(found, inputs.settle);
                begun.get_or_insert_with(Instant::now);
                watch.report(whole, &mut logs, ended, tell)?;
                open
            }
            Err(error) => {
                let why = explained(&error);
                if trouble.as_ref() != Some(&why) {
                    tell(Event::Trouble(&why));
                }
                trouble = Some(why);
                0
            }
        };
        watch.done.open = open;
        // At this look all that was there at the first one had rested long enough.
        let rested =
            open == 0 || begun.is_none_or(|begun| look.saturating_duration_since(begun) >= inputs.settle);
        if ended() || (inputs.once && rested) {
            return Ok(watch.done);
        }
        tell(Event::Waiting { reported: watch.folder.runs.len(), open });
        let waits = Instant::now();
        let every = if inputs.once { MOMENT } else { inputs.every };
        while waits.elapsed() < every && !ended() {
            thread::sleep(MOMENT.min(every));
        }
        there = found(&inputs.fleet.sources);
    }
}

/// A watch that has begun.
struct Watch<'a> {
    inputs: &'a Inputs,
    words: &'a Words<'a>,
    request_id: String,
    folder: Folder,
    done: Watched,
}

impl Watch<'_> {
    /// Reports logs that are whole; what was begun when the end is asked for is written, the others are left.
    fn report(
        &mut self,
        whole: Vec<Source>,
        logs: &mut Logs,
        ended: &(dyn Fn() -> bool + Sync),
        tell: &mut dyn FnMut(Event<'_>),
    ) -> Result<(), WatchFailure> {
        let mut shown = Instant::now();
        let mut changed = false;
        // Those with pages are looked up at once: a kill may have left them without rows.
        let (known, new): (Vec<Source>, Vec<Source>) =
            whole.into_iter().partition(|source| self.folder.has(source, &self.request_id));
        for batch in std::iter::once(known.as_slice()).chain(new.chunks(BATCH)) {
            if batch.is_empty() || ended() {
                continue;
            }
            changed |= self.batch(batch, logs, ended, tell)?;
            if changed && shown.elapsed() > INDEX_EVERY {
                self.folder.write_index(self.words)?;
                (shown, changed) = (Instant::now(), false);
            }
        }
        if changed { self.folder.write_index(self.words) } else { Ok(()) }
    }

    /// Whether anything was reported.
    fn batch(
        &mut self,
        batch: &[Source],
        logs: &mut Logs,
        ended: &(dyn Fn() -> bool + Sync),
        tell: &mut dyn FnMut(Event<'_>),
    ) -> Result<bool, WatchFailure> {
        let (root, request_id) = (self.inputs.fleet.into.as_path(), self.request_id.as_str());
        let page = self.words.page;
        let made: Mutex<Vec<(Result<Run, WatchFailure>, bool)>> = Mutex::default();
        let beside = Beside {
            gates: &self.inputs.gates,
            drawn: true,
            again: &|source| !self.folder.has(source, request_id),
            analysed: &|log, found| {
                let may_pass = matches!(found, Err((_, true)));
                let run = written(root, request_id, log, found, page);
                made.lock().unwrap_or_else(PoisonError::into_inner).push((run, may_pass));
            },
        };
        let seen = |_| if ended() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
        let scanned = match scan_these(batch.to_vec(), &self.inputs.fleet, &beside, &seen) {
            // A question is asked of the dataset, or it is tidied; these logs are taken at the next look.
            Err(FleetFailure::Locked { .. }) => return Ok(false),
            scanned => scanned?,
        };
        let mut runs = made.into_inner().unwrap_or_else(PoisonError::into_inner);
        runs.sort_by(|(a, _), (b, _)| {
            let log = |run: &Result<Run, WatchFailure>| run.as_ref().ok().map(|run| run.log.clone());
            log(a).cmp(&log(b))
        });
        for source in batch {
            logs.note(&source.path, &source.etag, false);
        }
        let before = self.done.reported / COMPACT_EVERY;
        let changed = !runs.is_empty();
        for (run, may_pass) in runs {
            let run = run?;
            logs.note(Path::new(&run.log), &run.log_etag, may_pass);
            self.done.reported += 1;
            self.done.not_kept += usize::from(run.verdict == Verdict::NotKept);
            self.done.doubtful += usize::from(run.remarks > 0);
            tell(Event::Reported(&run));
            self.folder.runs.insert(run.log.clone(), run);
        }
        self.done.remarks.extend(scanned.remarks);
        if self.done.reported / COMPACT_EVERY > before {
            match compact(root) {
                Err(FleetFailure::Locked { .. }) => {}
                done => drop(done?),
            }
        }
        Ok(changed)
    }
}

/// Writes the page of a log, then what is said of it.
fn written(
    root: &Path,
    request_id: &str,
    log: &Log,
    found: Analysed<'_>,
    page: &Page<'_>,
) -> Result<Run, WatchFailure> {
    let run = match found {
        Ok((report, findings)) => {
            let page = write_page(root, &log.uri, &page(report))?;
            Run::of(log, request_id, page, (report, findings))
        }
        Err((error, _)) => {
            remove_page(root, &log.uri)?;
            Run::failed(log, request_id, error)
        }
    };
    write_run(root, &run)?;
    Ok(run)
}
