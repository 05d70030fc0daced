//! The package hydrotrace-logs for Python: the crate's findings as functions and Arrow tables.
//!
//! `work` runs what takes time, `given` and `options` understand what callers give, `table` hands tables over, `answer` is what verbs
//! return; the others are a file a verb. What is public in Python is listed in `python/hydrotrace_logs/__init__.py`.

mod answer;
mod answers;
mod batch;
mod compare;
mod error;
mod fit;
mod given;
mod options;
mod plan;
mod read;
mod replan;
mod report;
mod scan;
mod table;
mod work;
mod writer;

use pyo3::prelude::*;

/// The compiled part of hydrotrace_logs.
#[pymodule]
mod _core {
    #[pymodule_export]
    use crate::{
        answer::Answer,
        answers::{drift, effect, worst},
        batch::rows_of,
        compare::compare,
        error::{FitError, FleetError, HydrotraceError, LogError, PlanError, WriteError},
        fit::{Fit, fit},
        plan::{Plan, plan},
        read::read,
        replan::replan,
        report::{Report, report, unpickled},
        scan::scan,
        table::Table,
        writer::LogWriter,
    };

    /// Version of hydrotrace.
    #[pymodule_export]
    const __VERSION__: &str = env!("CARGO_PKG_VERSION");
}
