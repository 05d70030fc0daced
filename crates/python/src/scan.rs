//! `scan`: logs into the fleet's dataset.

use std::{num::NonZeroUsize, ops::ControlFlow, path::PathBuf, thread::available_parallelism};

use hydrotrace::{
    log::dataset::{Cell, Column},
    workflow::fleet::{self, MachineFrom, Progress},
};
use pyo3::{prelude::*, types::PyDict};

use crate::{
    answer::Answer,
    error::{FleetError, raised},
    given::each,
    options::read_options,
    table::Table,
    work::{self, Stop},
};

const FAILURES: &[Column] = &[Column::text("log"), Column::text("error")];

/// Analyses the logs that the dataset in ``into`` does not hold yet, ``workers`` at once (by default one a core).
///
/// A source is a folder, a pattern, a list of logs (``.txt``), or a log. ``progress(done, of, failed)`` is called after
/// each log. A scan that is interrupted keeps what it analysed; the next one does the rest. The answer's table are the
/// logs that could not be analysed, with their errors.
#[pyfunction]
#[pyo3(signature = (sources, into, *, machine_from="log", workers=None, progress=None, **options))]
pub(crate) fn scan(
    py: Python<'_>,
    sources: &Bound<'_, PyAny>,
    into: PathBuf,
    machine_from: &str,
    workers: Option<usize>,
    progress: Option<Py<PyAny>>,
    options: Option<&Bound<'_, PyDict>>,
) -> PyResult<Answer> {
    let path = |source: &Bound<'_, PyAny>| Ok(source.extract::<PathBuf>()?.to_string_lossy().into_owned());
    let cores = || available_parallelism().map_or(1, NonZeroUsize::get);
    let inputs = fleet::Inputs {
        sources: each(sources).iter().map(path).collect::<PyResult<_>>()?,
        into,
        machine: MachineFrom::parse(machine_from).map_err(|error| raised::<FleetError>(py, &error))?,
        workers: workers.unwrap_or_else(cores),
        read: read_options(options)?,
        ..fleet::Inputs::default()
    };
    let stop = Stop::default();
    let ended = stop.clone();
    let seen = move |now: Progress| {
        if let Some(progress) = &progress {
            Python::try_attach(|py| {
                if let Err(error) = progress.call1(py, (now.done, now.of, now.failed)) {
                    error.write_unraisable(py, None);
                }
            });
        }
        if ended.is_set() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let done = work::run(py, Some(&stop), move || fleet::scan(&inputs, &seen))?;
    let done = done.map_err(|failure| raised::<FleetError>(py, &failure))?;
    let row = |one: &fleet::Failure| vec![Cell::from(one.log.as_str()), Cell::from(one.error.as_str())];
    let rows: Vec<_> = done.failures.iter().map(row).collect();
    Answer::of("scan", Table::of(FAILURES, &rows)?, done.remarks.as_slice(), &done)
}
