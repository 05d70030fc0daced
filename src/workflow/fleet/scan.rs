//! `fleet scan`: analyses the logs that the dataset does not hold yet, one log a thread, and writes their rows.
//!
//! Logs are taken in the order of their paths, a batch at a time; what a batch writes depends on nothing else, so the
//! number of threads changes no byte of the dataset.

use std::{
    collections::{BTreeMap, BTreeSet},
    num::NonZeroUsize,
    ops::ControlFlow,
    panic::{AssertUnwindSafe, catch_unwind},
    path::{Path, PathBuf},
    sync::{
        Mutex, PoisonError,
        atomic::{AtomicBool, AtomicUsize, Ordering},
    },
    thread::available_parallelism,
};

use super::{
    arrange::{Gathered, files, gather, place},
    document::{Failure, Scanned},
    failure::FleetFailure,
    limits,
    machine::MachineFrom,
    sources::{Source, sources},
    store::{Part, Place, Store, parts},
    tables::{self, Log, Name, Rows},
};
use crate::{
    document::explained,
    log::{
        LogError, ReadOptions,
        dataset::{Cell, read_table},
    },
    remark::Code,
    replay::Rules,
    workflow::report::{self, DelayModel, Findings, Gates, Report, ReportFailure, analysis_id, hash},
};

/// Logs of the first batch, and of the largest one: what is held in memory. Each has as many as all before it, so that a kill
/// loses no more than was kept.
const FIRST_BATCH: usize = 16;
const LARGEST_BATCH: usize = 512;
/// What ends the identity of an analysis that fits, too: all else is the same.
pub(super) const FITTED: &str = "-fit";
/// How often a log is tried at once whose file cannot be read.
const TRIES: u64 = 3;

/// What to scan, and how.
#[derive(Debug, Clone, Default)]
pub struct Inputs {
    /// Folders, patterns, lists of logs, and logs.
    pub sources: Vec<String>,
    /// The folder of the dataset.
    pub into: PathBuf,
    /// Where the name of a log's machine stands.
    pub machine: MachineFrom,
    /// Logs that are analysed at once; 0 stands for one a core, and for four a core where logs lie in stores.
    pub workers: usize,
    /// Whether each run is fitted too, for the table of limits; it takes some forty times as long.
    pub fit: bool,
    /// What to read, where a log alone does not tell.
    pub read: ReadOptions,
    /// Thresholds and windows.
    pub rules: Rules,
}

/// How far a scan is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Progress {
    /// Logs that were analysed.
    pub done: usize,
    /// Logs to analyse.
    pub of: usize,
    /// Logs among those done that could not be analysed.
    pub failed: usize,
}

/// What is done with each log beside its rows.
pub(in crate::workflow) struct Beside<'a> {
    /// Limits that its report judges.
    pub(in crate::workflow) gates: &'a Gates,
    /// Whether its report is drawn, with all signals and the reasons of delays.
    pub(in crate::workflow) drawn: bool,
    /// Whether a log is analysed although the dataset holds its rows.
    pub(in crate::workflow) again: &'a (dyn Fn(&Source) -> bool + Sync),
    /// Told of each log that was analysed, by any thread, before its rows are written.
    pub(in crate::workflow) analysed: &'a (dyn Fn(&Log, Analysed<'_>) + Sync),
}

/// A report with its findings; or why there is none, and whether that may pass.
pub(in crate::workflow) type Analysed<'a> = Result<(&'a Report, &'a Findings), (&'a str, bool)>;

/// A log as the dataset holds it.
#[derive(Debug, Clone)]
struct Known {
    etag: String,
    analysis_id: String,
    run_id: String,
    /// Whether it failed for a reason that may pass.
    again: bool,
    tries: u64,
    part: Part,
}

/// A log to analyse.
#[derive(Debug)]
struct Pending {
    source: Source,
    /// How often it was tried as it is.
    tries: u64,
    /// Whether the dataset holds rows of it, which give way.
    is_held: bool,
}

/// Scans; `seen` is told of each log, by any thread, and may end the scan: what was analysed until then is written.
///
/// # Errors
///
/// [`FleetFailure`] if a source leads nowhere or the dataset cannot be written; a log that cannot be analysed is a row
/// with its error.
pub fn scan(
    inputs: &Inputs,
    seen: &(dyn Fn(Progress) -> ControlFlow<()> + Sync),
) -> Result<Scanned, FleetFailure> {
    let beside = Beside { gates: &Gates::default(), drawn: false, again: &|_| false, analysed: &|_, _| () };
    let (found, tables_left, empty) = sources(&inputs.sources)?;
    let store = Store::open(&inputs.into)?;
    let sources: Vec<String> = inputs.sources.iter().map(|source| from_anywhere(source)).collect();
    store.begin(&sources)?;
    let (scanned, ended) = scan_into(&store, found, inputs, &beside, seen)?;
    if !ended {
        store.end(&sources)?;
    }
    let mut scanned = Scanned { tables_left, ..scanned };
    for message in empty {
        scanned.remarks.add(Code::MissingFile, 1, message);
    }
    Ok(scanned)
}

/// The same of these logs, whatever the sources; `beside` has its part of each.
pub(in crate::workflow) fn scan_these(
    found: Vec<Source>,
    inputs: &Inputs,
    beside: &Beside<'_>,
    seen: &(dyn Fn(Progress) -> ControlFlow<()> + Sync),
) -> Result<Scanned, FleetFailure> {
    Ok(scan_into(&Store::open(&inputs.into)?, found, inputs, beside, seen)?.0)
}

/// A source as it is called in any folder.
fn from_anywhere(source: &str) -> String {
    match std::path::absolute(source) {
        Ok(path) if !source.contains("://") => path.to_string_lossy().into_owned(),
        _ => source.to_owned(),
    }
}

/// What a scan of these logs did, and whether `seen` ended it.
fn scan_into(
    store: &Store,
    found: Vec<Source>,
    inputs: &Inputs,
    beside: &Beside<'_>,
    seen: &(dyn Fn(Progress) -> ControlFlow<()> + Sync),
) -> Result<(Scanned, bool), FleetFailure> {
    let mut held = known(store.root())?;
    let analysis_id = own_analysis_id(inputs);
    // A run that was fitted, too, tells all that one tells that was not.
    let fitted_id = own_analysis_id(&Inputs { fit: true, ..inputs.clone() });
    let mut scanned = Scanned::new(&inputs.into, found.len());
    let mut pending: Vec<Pending> = Vec::new();
    for source in found {
        let known = held.get(source.path.to_string_lossy().as_ref());
        let ids = [&analysis_id, &fitted_id];
        let same = known.filter(|known| known.etag == source.etag && ids.contains(&&known.analysis_id));
        if same.is_some_and(|known| !known.again) && !(beside.again)(&source) {
            scanned.unchanged += 1;
        } else {
            scanned.replaced += usize::from(known.is_some());
            // Other content or another analysis begins anew.
            let tries = same.map_or(0, |known| known.tries);
            pending.push(Pending { source, tries, is_held: known.is_some() });
        }
    }
    let (done, failed, ended) = (AtomicUsize::new(0), AtomicUsize::new(0), AtomicBool::new(false));
    let cores = available_parallelism().map_or(1, NonZeroUsize::get);
    let workers = match inputs.workers {
        // Waiting for a store takes no core.
        0 => cores * if pending.iter().any(|log| log.source.is_remote()) { 4 } else { 1 },
        workers => workers,
    };
    let mut done_before = 0;
    while done_before < pending.len() {
        let size = done_before.clamp(FIRST_BATCH, LARGEST_BATCH).min(pending.len() - done_before);
        let batch = &pending[done_before..done_before + size];
        done_before += size;
        let rows = at_once(batch.len(), workers, &ended, |k| {
            let (rows, failure) = analysed(&batch[k], &analysis_id, inputs, beside);
            let failed = failed.fetch_add(usize::from(failure.is_some()), Ordering::Relaxed);
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            let now = Progress { done, of: pending.len(), failed: failed + usize::from(failure.is_some()) };
            ended.fetch_or(seen(now).is_break(), Ordering::Relaxed);
            (&batch[k], rows, failure)
        });
        let old: Vec<&Pending> = rows.iter().map(|(log, ..)| *log).filter(|log| log.is_held).collect();
        let (rows, failures): (Vec<Rows>, Vec<Option<Failure>>) =
            rows.into_iter().map(|(_, rows, failure)| (rows, failure)).unzip();
        scanned.add(&rows, failures);
        let old: Vec<&Known> =
            old.iter().filter_map(|log| held.get(log.source.path.to_string_lossy().as_ref())).collect();
        let moved = !old.is_empty();
        write(store, rows, &old)?;
        if moved {
            // Rows that stayed lie in other parts now.
            held = known(store.root())?;
        }
        if ended.load(Ordering::Relaxed) {
            break;
        }
    }
    Ok((scanned, ended.into_inner()))
}

/// The analysis, with all that rows depend on beside the log.
pub fn own_analysis_id(inputs: &Inputs) -> String {
    let Inputs { machine, read, rules, fit, .. } = inputs;
    let id = hash([analysis_id(rules), format!("{read:?}"), format!("{machine:?}")]);
    if *fit { id + FITTED } else { id }
}

/// What the dataset holds, by log.
fn known(root: &Path) -> Result<BTreeMap<String, Known>, FleetFailure> {
    let columns = ["log_uri", "log_etag", "analysis_id", "run_id", "may_pass", "tries"]
        .map(|name| tables::column(Name::Runs, name));
    let mut known = BTreeMap::new();
    for part in parts(root, Name::Runs)? {
        for row in read_table(&root.join(part.path(Name::Runs)), &columns)?.rows {
            let text = |k: usize| row.get(k).and_then(Cell::as_text).unwrap_or_default().to_owned();
            let tries = row.get(5).and_then(Cell::as_whole).and_then(|tries| u64::try_from(tries).ok());
            let one = Known {
                etag: text(1),
                analysis_id: text(2),
                run_id: text(3),
                again: row.get(4).is_some_and(Cell::is_set),
                tries: tries.unwrap_or(0),
                part: part.clone(),
            };
            known.insert(text(0), one);
        }
    }
    Ok(known)
}

/// What `of` makes of the numbers below `count`, in order, on so many threads of their own; of those that were begun
/// before the end.
fn at_once<T: Send>(
    count: usize,
    workers: usize,
    ended: &AtomicBool,
    of: impl Fn(usize) -> T + Sync,
) -> Vec<T> {
    let next = AtomicUsize::new(0);
    let made = Mutex::new(Vec::with_capacity(count));
    std::thread::scope(|scope| {
        for _ in 0..workers.clamp(1, count.max(1)) {
            scope.spawn(|| {
                loop {
                    let k = next.fetch_add(1, Ordering::Relaxed);
                    if k >= count || ended.load(Ordering::Relaxed) {
                        return;
                    }
                    let one = of(k);
                    made.lock().unwrap_or_else(PoisonError::into_inner).push((k, one));
                }
            });
        }
    });
    let mut made = made.into_inner().unwrap_or_else(PoisonError::into_inner);
    made.sort_unstable_by_key(|(k, _)| *k);
    made.into_iter().map(|(_, one)| one).collect()
}

/// The rows of a log, and why it has one row only.
fn analysed(
    pending: &Pending,
    analysis_id: &str,
    inputs: &Inputs,
    beside: &Beside<'_>,
) -> (Rows, Option<Failure>) {
    let Pending { source, tries, .. } = pending;
    let request = report::Inputs {
        read: inputs.read.clone(),
        rules: inputs.rules.clone(),
        gates: beside.gates.clone(),
        with_signals: beside.drawn,
        delay_model: if beside.drawn { DelayModel::OfThisRunIfShort } else { DelayModel::None },
        ..report::Inputs::default()
    };
    let mut log = Log {
        uri: source.path.to_string_lossy().into_owned(),
        etag: source.etag.clone(),
        bytes: source.bytes,
        machine: None,
        analysis_id: analysis_id.to_owned(),
        tries: *tries,
    };
    let (mut error, mut may_pass) = (String::new(), true);
    for _ in 0..TRIES {
        log.tries += 1;
        let one = || {
            report::reported(source.inputs(), &request).map(|(report, found)| {
                let machine = inputs.machine.of(&source.path, Some(&found));
                (beside.analysed)(&Log { machine: machine.clone(), ..log.clone() }, Ok((&report, &found)));
                (machine, found)
            })
        };
        match catch_unwind(AssertUnwindSafe(one)) {
            Ok(Ok((machine, found))) => {
                log.machine = machine;
                let mut rows = tables::analysed(&log, &found);
                if inputs.fit {
                    rows.extend(limits::rows(&log, source.inputs(), &found.run_id, &inputs.read));
                }
                return (rows, None);
            }
            Ok(Err(failure)) => {
                may_pass = matches!(failure, ReportFailure::Log(LogError::File { .. } | LogError::Remote(_)));
                error = explained(&failure);
            }
            Err(_) => (error, may_pass) = ("the program failed on this log".to_owned(), false),
        }
        if !may_pass {
            break;
        }
    }
    log.machine = inputs.machine.of(&source.path, None);
    (beside.analysed)(&log, Err((&error, may_pass)));
    let failure = Failure { log: log.uri.clone(), error: error.clone() };
    (tables::failed(&log, &error, may_pass), Some(failure))
}

/// Writes the rows of a batch; rows of its logs that the dataset holds give way, the others of their parts stay.
fn write(store: &Store, batch: Vec<Rows>, old: &[&Known]) -> Result<(), FleetFailure> {
    let mut places: BTreeMap<Place, Gathered> = BTreeMap::new();
    for rows in batch {
        let Some((_, run)) = rows.iter().find(|(name, _)| *name == Name::Runs) else { continue };
        let gathered = places.entry(place(run)).or_default();
        for (name, row) in rows {
            gathered.entry(name).or_default().push(row);
        }
    }
    let parts: BTreeSet<&Part> = old.iter().map(|known| &known.part).collect();
    let gone: BTreeSet<&str> = old.iter().map(|known| known.run_id.as_str()).collect();
    let stays = |row: &Vec<Cell>| !row[0].as_text().is_some_and(|run_id| gone.contains(run_id));
    let mut remove = Vec::new();
    for part in parts {
        remove.extend(gather(store.root(), part, &stays, places.entry(part.place.clone()).or_default())?);
    }
    let mut put = Vec::new();
    for (place, gathered) in places {
        put.extend(files(place, gathered)?);
    }
    store.change(&put, &remove)
}
