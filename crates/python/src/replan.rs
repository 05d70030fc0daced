//! `replan`: plan and command of the next run.

use std::{collections::BTreeMap, ops::ControlFlow, path::PathBuf};

use hydrotrace::{
    fit::Learning,
    log::dataset::{Cell, Column},
    workflow::replan::{Inputs, ReplanDocument, run},
};
use pyo3::{prelude::*, types::PyDict};

use crate::{
    answer::Answer,
    error::{PlanError, WriteError, raised},
    given::Files,
    options::read_options,
    plan::{Plan, made},
    table::Table,
    work::{self, Stop},
};

const PREDICTED: &[Column] = &[
    Column::text("joint"),
    Column::text("kind"),
    Column::real("planned_onset_s"),
    Column::real("modelled_peak_rad"),
    Column::real("expected_peak_rad"),
    Column::real("peak_margin_rad"),
];

/// Plan and command of the next run, from logs of the last ones.
///
/// ``limits`` is a file that ``fit`` wrote, in place of a fit to the logs; ``task`` a task file in place of the last
/// log's. ``keep_plan`` changes the command alone. ``gain`` is the share of the correction to apply, 0 to 1;
/// ``max_correction_rad`` bounds the difference between command and plan, ``max_correction_m`` that of joints that slide. The other keywords are those for reading.
#[pyfunction]
#[pyo3(signature = (logs, *, limits=None, task=None, keep_plan=false, precompensate=true, retime=false, gain=1.0,
                    max_correction_rad=None, max_correction_m=None, max_time_growth=0.0, max_cost_growth=0.1, evaluations=20_000, seed=1,
                    rate_hz=100.0, threads=0, **options))]
pub(crate) fn replan(
    py: Python<'_>,
    logs: &Bound<'_, PyAny>,
    limits: Option<PathBuf>,
    task: Option<PathBuf>,
    keep_plan: bool,
    precompensate: bool,
    retime: bool,
    gain: f64,
    max_correction_rad: Option<f64>,
    max_correction_m: Option<f64>,
    max_time_growth: f64,
    max_cost_growth: f64,
    evaluations: u64,
    seed: u64,
    rate_hz: f64,
    threads: usize,
    options: Option<&Bound<'_, PyDict>>,
) -> PyResult<Py<Plan>> {
    let (files, read) = (Files::of(logs)?, read_options(options)?);
    let inputs = Inputs {
        logs: files.paths.clone(),
        read,
        limits,
        task,
        keep_plan,
        precompensate,
        retime,
        learning: Learning {
            gain,
            most_rad: max_correction_rad,
            most_m: max_correction_m,
            ..Learning::default()
        },
        time_growth: max_time_growth,
        cost_growth: max_cost_growth,
        evaluations,
        seed,
        ..Inputs::default()
    };
    let stop = Stop::default();
    let ended = stop.clone();
    let work = move || {
        // As long as the work lasts so do its files.
        let _files = files;
        run(&inputs, |_| if ended.is_set() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) })
    };
    let found = work::run(py, Some(&stop), move || work::on_threads(threads, work))?;
    let next = found.map_err(|failure| raised::<PlanError>(py, &failure))?;
    let rows = next.after.transitions.iter().map(|start| {
        vec![
            Cell::from(start.joint.as_str()),
            Cell::from(start.kind.name()),
            Cell::from(start.planned_onset_s),
            Cell::from(start.modelled_peak_rad),
            Cell::from(start.expected_peak_rad),
            Cell::from(start.peak_margin_rad),
        ]
    });
    let table = Table::of(PREDICTED, &rows.collect::<Vec<_>>())?;
    let answer = Answer::of("replan", table, next.remarks.as_slice(), &ReplanDocument::of(&next))?;
    let provenance = [
        ("fitted_to", next.fitted_to.join(", ")),
        ("retimed", next.retimed.to_string()),
        ("gain", gain.to_string()),
        ("seed", seed.to_string()),
    ];
    let provenance = BTreeMap::from(provenance.map(|(key, value)| (key.to_owned(), value)));
    let mcap = next.log(provenance, rate_hz).map_err(|error| raised::<WriteError>(py, &error))?;
    made(py, answer, mcap)
}
