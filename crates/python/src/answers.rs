//! `worst`, `drift` and `effect`: what the fleet's dataset answers.

use std::path::PathBuf;

use hydrotrace::{
    log::dataset::{Cell, Column},
    remark::Remarks,
    workflow::fleet::{
        self, By, Drift, Effect, Filter, FleetFailure, JointEffect, JointTrend, Worst, WorstJoint,
    },
};
use pyo3::{exceptions::PyValueError, prelude::*};
use serde::Serialize;

use crate::{
    answer::Answer,
    error::{FleetError, raised},
    options::instant_us,
    table::Table,
    work,
};

/// A column, and its cell of a row of a document.
type Of<D, R> = (Column, fn(&D, &R) -> Cell);

const WORST: &[Of<Worst, WorstJoint>] = &[
    (Column::text("machine"), |_, one| Cell::from(one.machine.as_str())),
    (Column::text("joint"), |_, one| Cell::from(one.joint.as_str())),
    (Column::text("metric"), |all, _| Cell::from(name(all.by))),
    (Column::text("unit"), |_, one| Cell::from(one.unit.as_str())),
    (Column::real("median"), |_, one| Cell::from(one.median)),
    (Column::real("p95"), |_, one| Cell::from(one.p95)),
    (Column::real("largest"), |_, one| Cell::from(one.largest)),
    (Column::real("above_fleet"), |_, one| Cell::from(one.above_fleet)),
    (Column::whole("starts"), |_, one| Cell::from(one.starts)),
    (Column::whole("runs"), |_, one| Cell::from(one.runs)),
    (Column::text("at"), |_, one| Cell::from(one.at.as_deref())),
    (Column::text("log"), |_, one| Cell::from(one.log.as_str())),
];

const DRIFT: &[Of<Drift, JointTrend>] = &[
    (Column::text("machine"), |_, one| Cell::from(one.machine.as_str())),
    (Column::text("joint"), |_, one| Cell::from(one.joint.as_str())),
    (Column::text("metric"), |_, one| Cell::from(name(one.metric))),
    (Column::text("unit"), |_, one| Cell::from(one.unit.as_str())),
    (Column::real("slope_per_day"), |_, one| Cell::from(one.slope_per_day)),
    (Column::real("slope_low"), |_, one| Cell::from(one.interval_95[0])),
    (Column::real("slope_high"), |_, one| Cell::from(one.interval_95[1])),
    (Column::real("p_value"), |_, one| Cell::from(one.p_value)),
    (Column::real("q_value"), |_, one| Cell::from(one.q_value)),
    (Column::flag("found"), |_, one| Cell::from(one.found)),
    (Column::real("stands_out"), |_, one| Cell::from(one.stands_out)),
    (Column::text("since"), |_, one| Cell::from(one.since.as_deref())),
    (Column::real("level"), |_, one| Cell::from(one.level)),
    (Column::whole("starts"), |_, one| Cell::from(one.starts)),
    (Column::whole("runs"), |_, one| Cell::from(one.runs)),
    (Column::real("days"), |_, one| Cell::from(one.days)),
    (Column::flag("is_step"), |_, one| Cell::from(one.is_step)),
    (Column::text("step_after"), |_, one| {
        Cell::from(one.step.as_ref().and_then(|step| step.after.as_deref()))
    }),
    (Column::text("step_by"), |_, one| Cell::from(one.step.as_ref().and_then(|step| step.by.as_deref()))),
    (Column::real("step_change"), |_, one| Cell::from(one.step.as_ref().map(|step| step.change))),
    (Column::real("step_low"), |_, one| Cell::from(one.step.as_ref().map(|step| step.interval_95[0]))),
    (Column::real("step_high"), |_, one| Cell::from(one.step.as_ref().map(|step| step.interval_95[1]))),
    (Column::real("step_q_value"), |_, one| Cell::from(one.step.as_ref().map(|step| step.q_value))),
];

const EFFECT: &[Of<Effect, JointEffect>] = &[
    (Column::text("machine"), |all, _| Cell::from(all.machine.as_str())),
    (Column::text("at"), |all, _| Cell::from(all.at.as_str())),
    (Column::text("joint"), |_, one| Cell::from(one.joint.as_str())),
    (Column::text("metric"), |_, one| Cell::from(name(one.metric))),
    (Column::text("unit"), |_, one| Cell::from(one.unit.as_str())),
    (Column::real("before"), |_, one| Cell::from(one.before)),
    (Column::real("change"), |_, one| Cell::from(one.change)),
    (Column::real("change_low"), |_, one| Cell::from(one.interval_95[0])),
    (Column::real("change_high"), |_, one| Cell::from(one.interval_95[1])),
    (Column::real("usual_change"), |_, one| Cell::from(one.usual_change)),
    (Column::whole("rank"), |_, one| Cell::from(one.rank)),
    (Column::whole("machines"), |_, one| Cell::from(one.of)),
    (Column::real("p_value"), |_, one| Cell::from(one.p_value)),
    (Column::real("q_value"), |_, one| Cell::from(one.q_value)),
    (Column::flag("found"), |_, one| Cell::from(one.found)),
    (Column::whole("starts"), |_, one| Cell::from(one.starts)),
];

fn name(by: By) -> &'static str {
    match by {
        By::Peak => "peak",
        By::Delay => "delay",
        By::Lag => "lag",
    }
}

fn metric(text: &str) -> PyResult<By> {
    let found = By::ALL.into_iter().find(|by| name(*by) == text);
    found.ok_or_else(|| {
        PyValueError::new_err(format!("by is {text:?}, expected \"peak\", \"delay\" or \"lag\""))
    })
}

/// The metrics that are asked for; without a word peak error and dead time, as on the command line.
fn metrics(by: Option<&str>) -> PyResult<Vec<By>> {
    by.map_or(Ok(vec![By::Peak, By::Delay]), |by| Ok(vec![metric(by)?]))
}

fn filter(
    machine: Option<String>,
    joint: Option<String>,
    since: Option<&Bound<'_, PyAny>>,
) -> PyResult<Filter> {
    Ok(Filter { machine, joint, since_us: since.map(instant_us).transpose()? })
}

/// Asks the dataset, and makes a table of the answer.
fn asked<D: Serialize + Send + 'static, R>(
    py: Python<'_>,
    (verb, columns): (&'static str, &[Of<D, R>]),
    ask: impl FnOnce() -> Result<D, FleetFailure> + Send + 'static,
    rows: impl Fn(&D) -> (&[R], &Remarks),
) -> PyResult<Answer> {
    let found = work::run(py, None, ask)?.map_err(|failure| raised::<FleetError>(py, &failure))?;
    let (rows, remarks) = rows(&found);
    let row = |one: &R| columns.iter().map(|(_, cell)| cell(&found, one)).collect();
    let cells: Vec<Vec<Cell>> = rows.iter().map(row).collect();
    let columns: Vec<Column> = columns.iter().map(|(column, _)| *column).collect();
    Answer::of(verb, Table::of(&columns, &cells)?, remarks.as_slice(), &found)
}

/// The joints of all machines, those with the largest peak errors ("peak"), dead times ("delay") or lags ("lag") first.
#[pyfunction]
#[pyo3(signature = (dataset, *, by="peak", machine=None, joint=None, since=None))]
pub(crate) fn worst(
    py: Python<'_>,
    dataset: PathBuf,
    by: &str,
    machine: Option<String>,
    joint: Option<String>,
    since: Option<&Bound<'_, PyAny>>,
) -> PyResult<Answer> {
    let (by, filter) = (metric(by)?, filter(machine, joint, since)?);
    asked(
        py,
        ("worst", WORST),
        move || fleet::worst(&dataset, &filter, by),
        |found| (&found.joints, &found.remarks),
    )
}

/// The joints that change over the days: slope a day with its 95 % interval, q-value, since when. ``by`` is "peak",
/// "delay" or "lag"; by default peak error and dead time.
#[pyfunction]
#[pyo3(signature = (dataset, *, by=None, machine=None, joint=None, since=None))]
pub(crate) fn drift(
    py: Python<'_>,
    dataset: PathBuf,
    by: Option<&str>,
    machine: Option<String>,
    joint: Option<String>,
    since: Option<&Bound<'_, PyAny>>,
) -> PyResult<Answer> {
    let (by, filter) = (metrics(by)?, filter(machine, joint, since)?);
    asked(
        py,
        ("drift", DRIFT),
        move || fleet::drift(&dataset, &filter, &by),
        |found| (&found.trends, &found.remarks),
    )
}

/// What a change of ``machine`` at ``at`` did, at the same starts of the same plans, less what the other machines changed
/// by in the same time.
#[pyfunction]
#[pyo3(signature = (dataset, *, machine, at, by=None, joint=None, since=None))]
pub(crate) fn effect(
    py: Python<'_>,
    dataset: PathBuf,
    machine: String,
    at: &Bound<'_, PyAny>,
    by: Option<&str>,
    joint: Option<String>,
    since: Option<&Bound<'_, PyAny>>,
) -> PyResult<Answer> {
    let (by, filter, at_us) = (metrics(by)?, filter(None, joint, since)?, instant_us(at)?);
    asked(
        py,
        ("effect", EFFECT),
        move || fleet::effect(&dataset, &machine, at_us, &filter, &by),
        |found| (&found.effects, &found.remarks),
    )
}
