//! `compare`: runs before and after a change.

use hydrotrace::{
    log::dataset::{Cell, Kind},
    replay::Keyed as _,
    workflow::compare::{Change, Inputs, TransitionPair, run},
};
use pyo3::{prelude::*, types::PyDict};
use serde::Serialize;

use crate::{
    answer::Answer,
    error::{HydrotraceError, LogError, raised},
    given::Files,
    options::read_options,
    table::Table,
    work,
};

/// Columns before those of the metrics.
const PAIR: [(&str, Kind); 9] = [
    ("joint", Kind::Text),
    ("unit", Kind::Text),
    ("kind", Kind::Text),
    ("direction", Kind::Whole),
    ("planned_onset_before_s", Kind::Real),
    ("planned_onset_after_s", Kind::Real),
    ("paired_by", Kind::Text),
    ("answer_before", Kind::Text),
    ("answer_after", Kind::Text),
];

/// A word of a document.
fn word(value: &impl Serialize) -> Cell {
    Cell::from(serde_json::to_string(value).ok().as_deref().map(|text| text.trim_matches('"')))
}

fn row(pair: &TransitionPair) -> Vec<Cell> {
    let mut row = vec![
        Cell::from(pair.joint.as_str()),
        Cell::from(pair.joint_kind.unit()),
        word(&pair.kind),
        Cell::Whole(pair.direction.into()),
        Cell::from(pair.planned_onset_before_s),
        Cell::from(pair.planned_onset_after_s),
        word(&pair.paired_by),
        word(&pair.answer_before),
        word(&pair.answer_after),
    ];
    let both = |change: &Change| [Cell::from(change.before), Cell::from(change.after)];
    row.extend(pair.changes.iter().flat_map(|(_, change)| both(change)));
    row
}

/// Compares runs of a task before and after a change; each side is one log or a list of logs, whose mean is compared.
///
/// The answer's table has a row for each start or reversal that both sides have, with each metric ``_before`` and
/// ``_after`` in SI units; ``document["verdict"]`` and ``document["summaries"]`` say whether chance explains the change.
#[pyfunction]
#[pyo3(signature = (before, after, **options))]
pub(crate) fn compare(
    py: Python<'_>,
    before: &Bound<'_, PyAny>,
    after: &Bound<'_, PyAny>,
    options: Option<&Bound<'_, PyDict>>,
) -> PyResult<Answer> {
    let (before, after, read) = (Files::of(before)?, Files::of(after)?, read_options(options)?);
    let compared = work::run(py, None, move || {
        let sides = [&before, &after].map(|side| side.paths.clone());
        let [before, after] = sides;
        hydrotrace::threads::alone(|| run(&Inputs { before, after, read, ..Inputs::default() }))
    })?;
    let found = compared.map_err(|failure| raised::<LogError>(py, &failure))?;
    let keys = hydrotrace::replay::Metric::<hydrotrace::replay::Transition>::rows();
    let metrics = keys
        .iter()
        .flat_map(|metric| ["before", "after"].map(|side| (format!("{}_{side}", metric.key()), Kind::Real)));
    let columns = PAIR.map(|(name, kind)| (name.to_owned(), kind)).into_iter().chain(metrics);
    let rows: Vec<_> = found.pairs.iter().map(row).collect();
    if rows.iter().any(|row| row.len() != PAIR.len() + 2 * keys.len()) {
        return Err(HydrotraceError::new_err("a pair has other metrics than the table"));
    }
    Answer::of("compare", Table::named(columns, &rows)?, found.remarks.as_slice(), &found)
}
