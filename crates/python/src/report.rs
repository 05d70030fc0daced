//! `report`: one log as tables.

use std::path::{Path, PathBuf};

use hydrotrace::{
    log::Input,
    workflow::{
        fleet::{self, Log, MachineFrom, TableName},
        report::{Findings, Inputs, ReportFailure, findings},
    },
};
use pyo3::{prelude::*, types::PyDict};

use crate::{
    answer::loaded,
    error::{FleetError, HydrotraceError, LogError, raised},
    given::inputs,
    options::read_options,
    table::Table,
    work,
};

/// How logs are analysed.
#[derive(Debug, Clone)]
pub(crate) struct Request {
    inputs: Inputs,
    machine: MachineFrom,
    analysis_id: String,
}

impl Request {
    pub(crate) fn of(
        py: Python<'_>,
        machine_from: &str,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let machine = MachineFrom::parse(machine_from).map_err(|error| raised::<FleetError>(py, &error))?;
        let read = read_options(options)?;
        let scan = fleet::Inputs { read: read.clone(), machine: machine.clone(), ..fleet::Inputs::default() };
        let analysis_id = fleet::own_analysis_id(&scan);
        Ok(Self { inputs: Inputs { read, ..Inputs::default() }, machine, analysis_id })
    }

    /// Analyses one run on the calling thread alone. What is known of the log comes with the failure, too.
    pub(crate) fn findings(&self, parts: Vec<Input>) -> (Log, Result<Findings, ReportFailure>) {
        let first = parts.first().map(|part| part.name().to_owned()).unwrap_or_default();
        let mut log = match parts.first() {
            Some(Input::Path(path)) => Log::at(path, self.analysis_id.clone()),
            _ => Log { uri: first.display().to_string(), ..Log::at(Path::new(""), self.analysis_id.clone()) },
        };
        let found = findings(parts, &self.inputs);
        if let Ok(found) = &found {
            log.bytes = found.report.logs.iter().map(|file| file.bytes).sum();
        }
        log.machine = self.machine.of(Path::new(&log.uri), found.as_ref().ok());
        (log, found)
    }
}

/// What a report is pickled as: findings, place, state and size of the log, machine, analysis.
type Pickled = (String, (String, String, u64), Option<String>, String);

/// The tracking error of one run. ``transitions``, ``joints``, ``run`` and ``remarks`` are tables with the columns of
/// the fleet's dataset: times in s, positions in the joint's ``unit``, rad or m. ``document`` is all of it.
#[pyclass(frozen, module = "hydrotrace_logs")]
#[derive(Debug)]
pub(crate) struct Report {
    found: Findings,
    log: Log,
    transitions: Table,
    joints: Table,
    run: Table,
    remarks: Table,
}

impl Report {
    fn of(found: Findings, log: Log) -> PyResult<Self> {
        let rows = fleet::rows(&log, &found);
        let table = |name: TableName| {
            let own = rows.iter().filter(|(table, _)| *table == name);
            Table::of(&name.columns(), &own.map(|(_, row)| row.clone()).collect::<Vec<_>>())
        };
        Ok(Self {
            transitions: table(TableName::Transitions)?,
            joints: table(TableName::Joints)?,
            run: table(TableName::Runs)?,
            remarks: table(TableName::Remarks)?,
            found,
            log,
        })
    }

    fn text(&self) -> PyResult<String> {
        serde_json::to_string(&self.found).map_err(|error| HydrotraceError::new_err(error.to_string()))
    }
}

#[pymethods]
impl Report {
    /// A row for each planned start and reversal.
    #[getter]
    fn transitions(&self) -> Table {
        self.transitions.clone()
    }

    /// A row for each joint.
    #[getter]
    fn joints(&self) -> Table {
        self.joints.clone()
    }

    /// One row: the run.
    #[getter]
    fn run(&self) -> Table {
        self.run.clone()
    }

    /// A row for each doubt about the log.
    #[getter]
    fn remarks(&self) -> Table {
        self.remarks.clone()
    }

    /// Identity of the run: of the name of its log and its content.
    #[getter]
    fn run_id(&self) -> &str {
        &self.found.run_id
    }

    /// Identity of the plan, equal for runs of one plan; None if no planned start was found.
    #[getter]
    fn plan_id(&self) -> Option<&str> {
        self.found.plan_id.as_deref()
    }

    /// The machine, where the log names it.
    #[getter]
    fn machine(&self) -> Option<&str> {
        self.log.machine.as_deref()
    }

    /// The report's JSON document as dicts and lists, in SI units.
    #[getter]
    fn document<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        loaded(py, &self.text()?)
    }

    fn __repr__(&self) -> String {
        let name = Path::new(&self.log.uri).file_name().unwrap_or_default().to_string_lossy().into_owned();
        let report = &self.found.report;
        let counts = [report.joints.len(), report.transitions.len(), report.remarks.len()];
        format!("<Report of {name}: {} joints, {} transitions, {} remarks>", counts[0], counts[1], counts[2])
    }

    /// For processes that send it to one another.
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Pickled)> {
        let Log { uri, etag, bytes, machine, analysis_id, .. } = self.log.clone();
        let make = py.import("hydrotrace_logs._core")?.getattr("unpickled")?;
        Ok((make, (self.text()?, (uri, etag, bytes), machine, analysis_id)))
    }
}

/// A report from what it was pickled as.
#[pyfunction]
pub(crate) fn unpickled(
    text: &str,
    known: (String, String, u64),
    machine: Option<String>,
    analysis_id: String,
) -> PyResult<Report> {
    let (uri, etag, bytes) = known;
    let found = serde_json::from_str(text).map_err(|error| HydrotraceError::new_err(error.to_string()))?;
    Report::of(found, Log { uri, etag, bytes, machine, analysis_id, tries: 1 })
}

/// Analyses one run.
///
/// ``log`` is a path (a file or a ROS 2 bag directory), bytes, a file object with ``read`` and ``seek``, or a list of
/// the parts of one run; ``data`` and ``name`` are bytes and what they are called. ``machine_from`` says where the
/// machine's name stands: "log", "path:N", "path:KEY", "topic" or a CSV file. ``urdf`` is the arm in place of the log's,
/// ``tool`` its link. The other keywords are the command line's options for reading.
///
/// Runs on one thread and begins no pool; other Python threads run meanwhile.
#[pyfunction]
#[pyo3(signature = (log=None, *, data=None, name=None, machine_from="log", urdf=None, tool=None, **options))]
pub(crate) fn report(
    py: Python<'_>,
    log: Option<&Bound<'_, PyAny>>,
    data: Option<&Bound<'_, PyAny>>,
    name: Option<String>,
    machine_from: &str,
    urdf: Option<PathBuf>,
    tool: Option<String>,
    options: Option<&Bound<'_, PyDict>>,
) -> PyResult<Report> {
    let mut request = Request::of(py, machine_from, options)?;
    (request.inputs.urdf, request.inputs.tool) = (urdf, tool);
    let parts = inputs(log, data, name)?;
    let (log, found) = work::run(py, None, move || request.findings(parts))?;
    match found {
        Ok(found) => Report::of(found, log),
        Err(failure) => Err(raised::<LogError>(py, &failure)),
    }
}
