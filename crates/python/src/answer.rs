//! What a verb returns: its main table, and all that it found as a document.

use hydrotrace::{document::pretty, remark::Remark};
use pyo3::{prelude::*, types::PyCapsule};
use serde::Serialize;

use crate::table::Table;

/// What a verb found. It is its main table, so ``polars.DataFrame(answer)`` and ``pyarrow.table(answer)`` take it as
/// it is; ``document`` holds all of it, in SI units.
#[pyclass(frozen, subclass, module = "hydrotrace_logs")]
#[derive(Debug)]
pub(crate) struct Answer {
    verb: &'static str,
    table: Table,
    remarks: Table,
    json: String,
}

impl Answer {
    pub(crate) fn of(
        verb: &'static str,
        table: Table,
        remarks: &[Remark],
        document: &impl Serialize,
    ) -> PyResult<Self> {
        Ok(Self { verb, table, remarks: Table::of_remarks(remarks)?, json: pretty(document) })
    }
}

#[pymethods]
impl Answer {
    /// The main table.
    #[getter]
    fn table(&self) -> Table {
        self.table.clone()
    }

    /// Doubts about the data: code, count, message.
    #[getter]
    fn remarks(&self) -> Table {
        self.remarks.clone()
    }

    /// The JSON document of the command line, as text.
    #[getter]
    fn json(&self) -> &str {
        &self.json
    }

    /// The same as dicts and lists.
    #[getter]
    fn document<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        loaded(py, &self.json)
    }

    fn __len__(&self) -> usize {
        self.table.rows()
    }

    fn __repr__(&self) -> String {
        format!("<{}: {} rows, {} remarks>", self.verb, self.table.rows(), self.remarks.rows())
    }

    #[pyo3(signature = (requested_schema=None))]
    fn __arrow_c_stream__<'py>(
        &self,
        py: Python<'py>,
        requested_schema: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyCapsule>> {
        self.table.__arrow_c_stream__(py, requested_schema)
    }

    fn __arrow_c_schema__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyCapsule>> {
        self.table.__arrow_c_schema__(py)
    }
}

/// A JSON text as Python's own values.
pub(crate) fn loaded<'py>(py: Python<'py>, json: &str) -> PyResult<Bound<'py, PyAny>> {
    py.import("json")?.call_method1("loads", (json,))
}
