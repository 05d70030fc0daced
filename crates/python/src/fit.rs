//! `fit`: what the machine does with what it is sent.

use hydrotrace::{
    fit::{Estimated, JointFit},
    log::dataset::{Cell, Column},
    workflow::fit::{FitDocument, Inputs, LimitsFile, run},
};
use pyo3::{prelude::*, types::PyDict};

use crate::{
    answer::Answer,
    error::{FitError, raised},
    given::Files,
    options::read_options,
    table::Table,
    work,
};

const LIMITS: &[Column] = &[
    Column::text("joint"),
    Column::text("quantity"),
    Column::real("value"),
    Column::real("low"),
    Column::real("high"),
    Column::flag("identified"),
    Column::real("lower_bound"),
    Column::real("upper_bound"),
    Column::real("held_out_r2"),
];

/// A fitted machine. Its table has a row for each joint and quantity, whose name ends in its unit: value, 95 % interval
/// ``low`` to ``high``, whether the logs decide it (``identified``), and bounds where a limit was not reached.
#[pyclass(frozen, extends = Answer, module = "hydrotrace_logs")]
#[derive(Debug)]
pub(crate) struct Fit {
    toml: String,
}

#[pymethods]
impl Fit {
    /// The file with limits, TOML, for ``replan(limits=...)`` and ``hydrotrace replan --limits``.
    #[getter]
    fn toml(&self) -> &str {
        &self.toml
    }
}

fn rows(joint: &JointFit) -> Vec<Vec<Cell>> {
    let row = |(name, known): (&str, Estimated)| {
        vec![
            Cell::from(joint.name.as_str()),
            Cell::from(name),
            Cell::from(known.value),
            Cell::from(known.interval.map(|interval| interval[0])),
            Cell::from(known.interval.map(|interval| interval[1])),
            Cell::from(known.identified),
            Cell::from(known.lower_bound),
            Cell::from(known.upper_bound),
            Cell::from(joint.held_out_r2),
        ]
    };
    joint.quantities().map(row).into()
}

/// Fits every joint to all logs of one machine: dead time, dead band, gains, limits.
///
/// ``command`` and ``valve`` name topics beside the options for reading. Runs on ``threads`` threads of its own, by
/// default one a core.
#[pyfunction]
#[pyo3(signature = (logs, *, threads=0, **options))]
pub(crate) fn fit(
    py: Python<'_>,
    logs: &Bound<'_, PyAny>,
    threads: usize,
    options: Option<&Bound<'_, PyDict>>,
) -> PyResult<Py<Fit>> {
    let (files, read) = (Files::of(logs)?, read_options(options)?);
    let fitted = work::run(py, None, move || {
        work::on_threads(threads, || run(&Inputs { logs: files.paths.clone(), read }))
    })?;
    let fitted = fitted.map_err(|failure| raised::<FitError>(py, &failure))?;
    let toml = LimitsFile::of(&fitted).toml().map_err(|error| raised::<FitError>(py, &error))?;
    let document = FitDocument::of(&fitted);
    let table = Table::of(LIMITS, &fitted.fit.joints.iter().flat_map(rows).collect::<Vec<_>>())?;
    let answer = Answer::of("fit", table, &document.remarks, &document)?;
    Py::new(py, PyClassInitializer::from(answer).add_subclass(Fit { toml }))
}
