//! Errors as exceptions, with the words of the command line: each reason after a colon.

use std::{error::Error, io};

use hydrotrace::document::explained;
use pyo3::{PyTypeInfo, create_exception, exceptions::PyException, prelude::*};

create_exception!(hydrotrace_logs, HydrotraceError, PyException, "What hydrotrace could not do, and why.");
create_exception!(
    hydrotrace_logs,
    LogError,
    HydrotraceError,
    "A log cannot be read, or holds no plan and measurement that belong together."
);
create_exception!(hydrotrace_logs, FitError, HydrotraceError, "Logs from which no machine can be fitted.");
create_exception!(hydrotrace_logs, PlanError, HydrotraceError, "A task that cannot be planned.");
create_exception!(hydrotrace_logs, FleetError, HydrotraceError, "A dataset that cannot be written or read.");
create_exception!(hydrotrace_logs, WriteError, HydrotraceError, "A log that cannot be written.");

/// The exception for an error. Where the file system said no, `__cause__` is Python's own exception for that.
pub(crate) fn raised<X: PyTypeInfo>(py: Python<'_>, error: &(dyn Error + 'static)) -> PyErr {
    let exception = PyErr::new::<X, _>(explained(error));
    let mut cause = Some(error);
    while let Some(inner) = cause {
        if let Some(code) = inner.downcast_ref::<io::Error>().and_then(io::Error::raw_os_error) {
            exception.set_cause(py, Some(io::Error::from_raw_os_error(code).into()));
        }
        cause = inner.source();
    }
    exception
}
