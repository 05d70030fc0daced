//! `plan`: the best timings of a task, and the log of what to send.

use std::{ops::ControlFlow, path::PathBuf};

use hydrotrace::{
    log::dataset::{Cell, Kind},
    moea::{ALGORITHMS, Budget, NamedAlgorithm},
    plan::{PlanEvaluation, Search},
    workflow::{
        carried::{
            Carried,
            plan_log::{PlanLog, Planned},
        },
        plan::{self as planning, Options, PlanDocument, PlanFailure, PlanRequest, Shaping},
    },
};
use pyo3::{prelude::*, types::PyBytes};

use crate::{
    answer::Answer,
    error::{PlanError, WriteError, raised},
    table::Table,
    work::{self, Stop},
};

/// A plan, and after ``replan`` a command for it. Its table has a row for each plan found (``plan``) or for each start
/// with its predicted error (``replan``).
#[pyclass(frozen, extends = Answer, module = "hydrotrace_logs")]
#[derive(Debug)]
pub(crate) struct Plan {
    mcap: Vec<u8>,
}

#[pymethods]
impl Plan {
    /// The plan and its command as the bytes of an MCAP log: write them to a file, or send its trajectory.
    #[getter]
    fn mcap<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, &self.mcap)
    }
}

/// With the log that it is.
pub(crate) fn made(py: Python<'_>, answer: Answer, mcap: Vec<u8>) -> PyResult<Py<Plan>> {
    Py::new(py, PyClassInitializer::from(answer).add_subclass(Plan { mcap }))
}

/// The log of a plan, and its document.
fn written(request: &PlanRequest, document: &PlanDocument, rate_hz: f64) -> PyResult<Vec<u8>> {
    let entry = &document.chosen.entry;
    let motion = request.setup.motion_through(&entry.times_s, &entry.via).map_err(PlanFailure::from);
    let motion = Python::attach(|py| motion.map_err(|failure| raised::<PlanError>(py, &failure)))?;
    let log = PlanLog {
        plan: Planned::Motion(&motion, &document.joints),
        command: None,
        arm: Some(&request.setup.arm().chain),
        trajectory: None,
        carried: &Carried::default().with_plan(&request.files, document),
        rate_hz,
        points_hz: request.setup.points_hz(&motion),
    };
    log.bytes().map_err(|error| Python::attach(|py| raised::<WriteError>(py, &error)))
}

/// A row for each plan: its objectives, then its arrivals at the key points.
fn front(document: &PlanDocument) -> PyResult<Table> {
    let plans = if document.front.is_empty() {
        std::slice::from_ref(&document.chosen.entry)
    } else {
        &document.front
    };
    let points = plans.iter().map(|plan| plan.times_s.len()).max().unwrap_or(0);
    let objectives = ["duration_s", "rms_jerk_rad_s3", "rms_power_w"].map(str::to_owned);
    let arrivals = (0..points).map(|point| format!("arrival_{}_s", point + 1));
    let columns = objectives.into_iter().chain(arrivals).map(|name| (name, Kind::Real));
    let row = |plan: &planning::PlanEntry| -> Vec<Cell> {
        let objectives = plan.objectives.plan().iter().copied().map(Cell::from);
        objectives.chain(plan.times_s.iter().map(|time_s| Cell::from(*time_s))).collect()
    };
    Table::named(columns, &plans.iter().map(row).collect::<Vec<_>>())
}

/// Searches the best timings of a task file, or evaluates ``times_s``, the arrivals at its key points.
///
/// ``shape`` is "timing", or "free" for free points between the key points. The log has ``rate_hz`` samples a second.
/// The same seed gives the same plans on any number of threads.
#[pyfunction]
#[pyo3(signature = (task, *, times_s=None, evaluations=20_000, seed=1, shape="timing", rate_hz=100.0, threads=0))]
pub(crate) fn plan(
    py: Python<'_>,
    task: PathBuf,
    times_s: Option<Vec<f64>>,
    evaluations: u64,
    seed: u64,
    shape: &str,
    rate_hz: f64,
    threads: usize,
) -> PyResult<Py<Plan>> {
    let shape = match shape {
        "timing" => Shaping::Timing,
        "free" => Shaping::Free(None),
        other => {
            return Err(PlanError::new_err(format!("shape is {other:?}, expected \"timing\" or \"free\"")));
        }
    };
    let stop = Stop::default();
    let ended = stop.clone();
    let work = move || -> Result<(PlanRequest, PlanDocument), PlanFailure> {
        let request = PlanRequest::read(&task)?;
        let title = request.task.title.clone();
        if let Some(times_s) = times_s.or_else(|| request.task.times_s.clone()) {
            let evaluation = PlanEvaluation::of(&request.setup, &times_s)?;
            let document = PlanDocument::evaluated(&title, &request.setup.joint_names(), &evaluation, true);
            return Ok((request, document));
        }
        let search = Search { budget: Budget::Evaluations(evaluations), seed, ..Search::default() };
        let options = Options { search, shape, ..Options::default() };
        let named = |known: &&NamedAlgorithm| known.algorithm == options.search.algorithm;
        let algorithm = ALGORITHMS.iter().find(named).map_or("", |known| known.title);
        let planned = planning::run(&request, &options, |_| {
            if ended.is_set() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        })?;
        let document = PlanDocument::searched(&title, algorithm, &options, &planned);
        Ok((request, document))
    };
    let found = work::run(py, Some(&stop), move || work::on_threads(threads, work))?;
    let (request, document) = found.map_err(|failure| raised::<PlanError>(py, &failure))?;
    let answer = Answer::of("plan", front(&document)?, &document.remarks, &document)?;
    made(py, answer, written(&request, &document, rate_hz)?)
}
