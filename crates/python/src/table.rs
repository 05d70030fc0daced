//! Tables that are handed over through Arrow's C stream interface, without copying.

use std::sync::Arc;

use arrow_array::{
    Array, ArrayRef, BooleanArray, Float64Array, Int64Array, RecordBatch, RecordBatchIterator, StringArray,
    TimestampMicrosecondArray, cast::AsArray as _, ffi_stream::FFI_ArrowArrayStream, types,
};
use arrow_schema::{ArrowError, DataType, Field, Schema, TimeUnit, ffi::FFI_ArrowSchema};
use hydrotrace::{
    log::dataset::{Cell, Column, Kind},
    remark::Remark,
    workflow::fleet::TableName,
};
use pyo3::{
    exceptions::PyKeyError,
    prelude::*,
    types::{PyCapsule, PyDelta, PyDict, PyList, PyString},
};

use crate::error::{HydrotraceError, raised};

/// A table: columns with their units in their names, and rows. Anything that reads Arrow's PyCapsule interface takes
/// it without copying: ``pyarrow.table(t)``, ``polars.DataFrame(t)``, DuckDB. ``t["column"]`` is a list and
/// ``t.to_dicts()`` are the rows, for those who have none of them.
#[pyclass(frozen, module = "hydrotrace_logs")]
#[derive(Debug, Clone)]
pub(crate) struct Table(RecordBatch);

impl Table {
    /// Of rows that have a cell for each column.
    pub(crate) fn of(columns: &[Column], rows: &[Vec<Cell>]) -> PyResult<Self> {
        Self::named(columns.iter().map(|column| (column.name, column.kind)), rows)
    }

    /// The same, of columns whose names are made.
    pub(crate) fn named<N: Into<String>>(
        columns: impl IntoIterator<Item = (N, Kind)>,
        rows: &[Vec<Cell>],
    ) -> PyResult<Self> {
        let column = |(k, (name, kind)): (usize, (N, Kind))| {
            (Field::new(name, data_type(kind), true), array(kind, rows, k))
        };
        let (fields, arrays) = columns.into_iter().enumerate().map(column).unzip();
        Self::from_arrays(fields, arrays, rows.len())
    }

    /// Of columns of equal length.
    pub(crate) fn from_arrays(fields: Vec<Field>, arrays: Vec<ArrayRef>, rows: usize) -> PyResult<Self> {
        let options = arrow_array::RecordBatchOptions::new().with_row_count(Some(rows));
        let batch = RecordBatch::try_new_with_options(Arc::new(Schema::new(fields)), arrays, &options);
        Ok(Self(batch.map_err(of_arrow)?))
    }

    /// Doubts about data, in the columns of the dataset that do not name the run.
    pub(crate) fn of_remarks(remarks: &[Remark]) -> PyResult<Self> {
        let columns: Vec<Column> = TableName::Remarks
            .columns()
            .iter()
            .filter(|c| !["run_id", "machine"].contains(&c.name))
            .copied()
            .collect();
        let row = |remark: &Remark| {
            let code = remark.code.name();
            vec![Cell::from(code.as_str()), Cell::from(remark.count), Cell::from(remark.message.as_str())]
        };
        Self::of(&columns, &remarks.iter().map(row).collect::<Vec<_>>())
    }

    pub(crate) fn rows(&self) -> usize {
        self.0.num_rows()
    }
}

fn of_arrow(error: ArrowError) -> PyErr {
    HydrotraceError::new_err(error.to_string())
}

fn data_type(kind: Kind) -> DataType {
    match kind {
        Kind::Text => DataType::Utf8,
        Kind::Real => DataType::Float64,
        Kind::Whole => DataType::Int64,
        Kind::Flag => DataType::Boolean,
        Kind::Instant => DataType::Timestamp(TimeUnit::Microsecond, Some("UTC".into())),
    }
}

fn array(kind: Kind, rows: &[Vec<Cell>], k: usize) -> ArrayRef {
    let cells = || rows.iter().map(|row| row.get(k).unwrap_or(&Cell::None));
    let flag = |cell: &Cell| if let Cell::Flag(is) = cell { Some(*is) } else { None };
    match kind {
        Kind::Text => Arc::new(cells().map(Cell::as_text).collect::<StringArray>()),
        Kind::Real => Arc::new(cells().map(Cell::as_real).collect::<Float64Array>()),
        Kind::Whole => Arc::new(cells().map(Cell::as_whole).collect::<Int64Array>()),
        Kind::Flag => Arc::new(cells().map(flag).collect::<BooleanArray>()),
        Kind::Instant => {
            let instants: TimestampMicrosecondArray = cells().map(Cell::as_whole).collect();
            Arc::new(instants.with_timezone("UTC"))
        }
    }
}

/// One value for Python.
fn value<'py>(py: Python<'py>, array: &dyn Array, row: usize) -> PyResult<Bound<'py, PyAny>> {
    if array.is_null(row) {
        return Ok(py.None().into_bound(py));
    }
    Ok(match array.data_type() {
        DataType::Utf8 => array.as_string::<i32>().value(row).into_pyobject(py)?.into_any(),
        DataType::Float64 => {
            array.as_primitive::<types::Float64Type>().value(row).into_pyobject(py)?.into_any()
        }
        DataType::Int64 => array.as_primitive::<types::Int64Type>().value(row).into_pyobject(py)?.into_any(),
        DataType::Int32 => array.as_primitive::<types::Int32Type>().value(row).into_pyobject(py)?.into_any(),
        DataType::Boolean => array.as_boolean().value(row).into_pyobject(py)?.to_owned().into_any(),
        DataType::Dictionary(..) => {
            let array = array.as_dictionary::<types::Int32Type>();
            let key = usize::try_from(array.keys().value(row)).unwrap_or_default();
            value(py, array.values().as_ref(), key)?
        }
        _ => {
            let us = array.as_primitive::<types::TimestampMicrosecondType>().value(row);
            let [days, rest] = [us.div_euclid(86_400_000_000), us.rem_euclid(86_400_000_000)];
            let part = |value: i64| i32::try_from(value).unwrap_or_default();
            let since = PyDelta::new(py, part(days), part(rest / 1_000_000), part(rest % 1_000_000), true)?;
            let datetime = py.import("datetime")?;
            let utc = datetime.getattr("timezone")?.getattr("utc")?;
            let epoch = datetime.getattr("datetime")?.call1((1970, 1, 1, 0, 0, 0, 0, utc))?;
            epoch.add(since)?
        }
    })
}

#[pymethods]
impl Table {
    /// Names of the columns.
    #[getter]
    fn columns(&self) -> Vec<String> {
        self.0.schema().fields().iter().map(|field| field.name().clone()).collect()
    }

    /// The rows, a dict each; what is not known is None.
    fn to_dicts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let schema = self.0.schema();
        let names: Vec<Bound<'py, PyString>> =
            schema.fields().iter().map(|field| PyString::intern(py, field.name())).collect();
        let rows = PyList::empty(py);
        for row in 0..self.0.num_rows() {
            let dict = PyDict::new(py);
            for (name, column) in names.iter().zip(self.0.columns()) {
                dict.set_item(name, value(py, column.as_ref(), row)?)?;
            }
            rows.append(dict)?;
        }
        Ok(rows)
    }

    fn __getitem__<'py>(&self, py: Python<'py>, column: &str) -> PyResult<Bound<'py, PyList>> {
        let Some(array) = self.0.column_by_name(column) else {
            let message = format!("no column {column:?}; the table has {}", self.columns().join(", "));
            return Err(PyKeyError::new_err(message));
        };
        let values: PyResult<Vec<_>> = (0..array.len()).map(|row| value(py, array.as_ref(), row)).collect();
        PyList::new(py, values?)
    }

    fn __len__(&self) -> usize {
        self.0.num_rows()
    }

    fn __repr__(&self) -> String {
        format!("<Table: {} rows, columns {}>", self.0.num_rows(), self.columns().join(", "))
    }

    /// The table as a capsule with an Arrow C stream; its buffers are those of this table.
    #[pyo3(signature = (requested_schema=None))]
    pub(crate) fn __arrow_c_stream__<'py>(
        &self,
        py: Python<'py>,
        requested_schema: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyCapsule>> {
        // The interface lets a table stay as it is where another form is asked for.
        drop(requested_schema);
        let batches = RecordBatchIterator::new([Ok(self.0.clone())], self.0.schema());
        let stream = FFI_ArrowArrayStream::new(Box::new(batches));
        PyCapsule::new_with_value(py, stream, c"arrow_array_stream")
    }

    /// The columns as a capsule with an Arrow C schema.
    pub(crate) fn __arrow_c_schema__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyCapsule>> {
        let schema = FFI_ArrowSchema::try_from(self.0.schema().as_ref());
        let schema = schema.map_err(|error| raised::<HydrotraceError>(py, &error))?;
        PyCapsule::new_with_value(py, schema, c"arrow_schema")
    }
}
