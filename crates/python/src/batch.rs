//! Rows of many logs for engines that spread work: a log that fails is a row with its error.

use std::panic::{AssertUnwindSafe, catch_unwind};

use hydrotrace::{
    document::explained,
    log::{
        Input,
        dataset::{Cell, Column},
    },
    workflow::fleet::{self, Log, TableName},
};
use pyo3::{exceptions::PyValueError, prelude::*, types::PyDict};

use crate::{
    given::{each, input},
    report::Request,
    table::Table,
    work::{self, Stop},
};

/// What a row says beside the columns of its table, where these do not say it.
const ADDED: [Column; 2] = [Column::text("log_uri"), Column::text("error")];

/// A log, or why it is none.
type Given = (String, Result<Vec<Input>, String>);

/// The rows of some logs in one table of the dataset: "transitions", "joints", "remarks" or "runs". All but "runs" also
/// have ``log_uri`` and ``error``; a log without a row of its own has one that names it, so that none is lost.
#[pyfunction]
#[pyo3(signature = (table, logs, names=None, *, machine_from="log", **options))]
pub(crate) fn rows_of(
    py: Python<'_>,
    table: &str,
    logs: Vec<Bound<'_, PyAny>>,
    names: Option<Vec<String>>,
    machine_from: &str,
    options: Option<&Bound<'_, PyDict>>,
) -> PyResult<Table> {
    let table = match table {
        "transitions" => TableName::Transitions,
        "joints" => TableName::Joints,
        "remarks" => TableName::Remarks,
        "runs" => TableName::Runs,
        other => {
            let message = format!("no table {other:?}; there are transitions, joints, remarks, runs");
            return Err(PyValueError::new_err(message));
        }
    };
    let request = Request::of(py, machine_from, options)?;
    let names = names.unwrap_or_default();
    let given = |(k, log): (usize, &Bound<'_, PyAny>)| -> Given {
        let name = names.get(k).cloned();
        let parts: PyResult<Vec<Input>> = each(log).iter().map(|part| input(part, name.clone())).collect();
        (name.unwrap_or_else(|| log.to_string()), parts.map_err(|error| error.value(py).to_string()))
    };
    let logs: Vec<Given> = logs.iter().enumerate().map(given).collect();
    let stop = Stop::default();
    let ended = stop.clone();
    let rows = work::run(py, Some(&stop), move || {
        let going_on = logs.into_iter().take_while(|_| !ended.is_set());
        going_on.flat_map(|log| of_log(table, &request, log)).collect::<Vec<_>>()
    })?;
    let added = if table == TableName::Runs { &[][..] } else { &ADDED[..] };
    Table::of(&[&table.columns()[..], added].concat(), &rows)
}

/// The rows of one log, at least one.
fn of_log(table: TableName, request: &Request, (name, parts): Given) -> Vec<Vec<Cell>> {
    let unknown = |name: String| Log { uri: name, ..Log::at("".as_ref(), String::new()) };
    let (log, found) = match parts {
        Err(error) => (unknown(name), Err(error)),
        Ok(parts) => match catch_unwind(AssertUnwindSafe(|| request.findings(parts))) {
            Ok((log, found)) => (log, found.map_err(|failure| explained(&failure))),
            Err(panic) => (unknown(name), Err(work::told(&*panic))),
        },
    };
    let (all, error) = match found {
        Ok(found) => (fleet::rows(&log, &found), None),
        Err(error) => (fleet::failed_rows(&log, &error, false), Some(error)),
    };
    let own = |row: Vec<Cell>| {
        let added = [Cell::from(log.uri.as_str()), Cell::from(error.as_deref())];
        if table == TableName::Runs { row } else { row.into_iter().chain(added).collect() }
    };
    let (own_rows, rest): (Vec<_>, Vec<_>) = all.into_iter().partition(|(name, _)| *name == table);
    if own_rows.is_empty() {
        // Which run and machine: the first two columns of every table.
        let names = rest
            .into_iter()
            .find(|(name, _)| *name == TableName::Runs)
            .map(|(_, row)| row)
            .unwrap_or_default();
        let mut row = vec![Cell::None; table.columns().len()];
        row.iter_mut().zip(names).take(2).for_each(|(cell, name)| *cell = name);
        return vec![own(row)];
    }
    own_rows.into_iter().map(|(_, row)| own(row)).collect()
}
