//! `read`: plan, measurement and command as a table of samples.

use std::sync::Arc;

use arrow_array::{
    ArrayRef, DictionaryArray, Float64Array, Int32Array, Int64Array, StringArray, types::Int32Type,
};
use arrow_schema::{DataType, Field};
use hydrotrace::{
    log::{LogFiles, ReadOptions, Recording, Sides, SignalRole, SourceInfo},
    series::{Series, Track},
    threads::alone,
};
use pyo3::{prelude::*, types::PyDict};
use serde::Serialize;

use crate::{
    answer::Answer,
    error::{HydrotraceError, LogError, raised},
    given::inputs,
    options::read_options,
    table::Table,
    work,
};

/// Where the samples come from.
#[derive(Serialize)]
struct Document {
    source: SourceInfo,
    plan_is_command: bool,
    command_topic: Option<String>,
}

/// Repeated texts, each kept once.
fn dictionary<'a>(texts: impl Iterator<Item = (&'a str, usize)>) -> PyResult<ArrayRef> {
    let (mut known, mut keys): (Vec<&str>, Vec<i32>) = (Vec::new(), Vec::new());
    for (text, count) in texts {
        let place = known.iter().position(|one| *one == text).unwrap_or_else(|| {
            known.push(text);
            known.len() - 1
        });
        keys.extend(std::iter::repeat_n(i32::try_from(place).unwrap_or(i32::MAX), count));
    }
    let texts = Arc::new(StringArray::from(known));
    let array = DictionaryArray::<Int32Type>::try_new(Int32Array::from(keys), texts);
    Ok(Arc::new(array.map_err(|error| HydrotraceError::new_err(error.to_string()))?))
}

/// For each sample the number of its segment, from 0: between two segments time is not continuous.
fn segments(track: &Track) -> impl Iterator<Item = i64> {
    (0..).zip(track.segments()).flat_map(|(number, segment)| std::iter::repeat_n(number, segment.len()))
}

fn samples(recording: &Recording) -> PyResult<Table> {
    let empty = Series::default();
    let command = recording.command.as_ref().map_or(&empty, |command| &command.series);
    let sides = [("planned", &recording.planned), ("measured", &recording.measured), ("command", command)];
    let tracks: Vec<(&str, &Track)> =
        sides.iter().flat_map(|(name, series)| series.tracks.iter().map(|track| (*name, track))).collect();
    let each = || tracks.iter().map(|(_, track)| *track);
    let known = |track: &Track| -> Vec<Option<f64>> {
        let velocity = |velocity: &[f64]| velocity.iter().copied().map(Some).collect();
        track.velocity().map_or_else(|| vec![None; track.t_s().len()], velocity)
    };
    let texts: [(&str, ArrayRef); 3] = [
        ("signal", dictionary(tracks.iter().map(|(name, track)| (*name, track.t_s().len())))?),
        ("joint", dictionary(each().map(|track| (track.name(), track.t_s().len())))?),
        ("unit", dictionary(each().map(|track| (track.kind().unit(), track.t_s().len())))?),
    ];
    let reals = |values: Vec<f64>| -> ArrayRef { Arc::new(Float64Array::from(values)) };
    let numbers: [(&str, ArrayRef); 4] = [
        ("segment", Arc::new(each().flat_map(segments).collect::<Int64Array>())),
        ("t_s", reals(each().flat_map(Track::t_s).copied().collect())),
        ("position", reals(each().flat_map(Track::position).copied().collect())),
        ("velocity", Arc::new(each().flat_map(known).collect::<Float64Array>())),
    ];
    let rows: usize = each().map(|track| track.t_s().len()).sum();
    let field =
        |(name, array): &(&str, ArrayRef)| Field::new(*name, DataType::clone(array.data_type()), true);
    let all: Vec<(&str, ArrayRef)> = texts.into_iter().chain(numbers).collect();
    Table::from_arrays(
        all.iter().map(field).collect(),
        all.into_iter().map(|(_, array)| array).collect(),
        rows,
    )
}

/// The samples of a log: a row for each signal ("planned", "measured", "command"), joint and instant.
///
/// ``t_s`` counts from the start of the log, ``position`` is in ``unit`` (rad or m), ``velocity`` in that a second where
/// the log has it, ``segment`` grows where time is not continuous. ``document["source"]`` says which topics these are.
#[pyfunction]
#[pyo3(signature = (log=None, *, data=None, name=None, **options))]
pub(crate) fn read(
    py: Python<'_>,
    log: Option<&Bound<'_, PyAny>>,
    data: Option<&Bound<'_, PyAny>>,
    name: Option<String>,
    options: Option<&Bound<'_, PyDict>>,
) -> PyResult<Answer> {
    let parts = inputs(log, data, name)?;
    let options = read_options(options)?.wanting(&[SignalRole::Command]);
    let options = ReadOptions { sides: Sides::Any, measured_velocities: true, ..options };
    let found = work::run(py, None, move || alone(|| LogFiles::of(parts)?.scan()?.read(&options)))?;
    let recording = found.map_err(|failure| raised::<LogError>(py, &failure))?;
    let document = Document {
        source: recording.source.clone(),
        plan_is_command: recording.plan_is_command,
        command_topic: recording.command.as_ref().map(|command| command.topic.clone()),
    };
    Answer::of("read", samples(&recording)?, recording.remarks.as_slice(), &document)
}
