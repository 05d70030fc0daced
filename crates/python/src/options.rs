//! Options as callers give them: those of the command line for reading, as keywords; days and instants.

use hydrotrace::{
    log::{Cylinders, LengthUnit, ReadOptions, Selector, SignalRole, TimeBase, TimeRange, WantedSignal},
    series::JointKind,
};
use pyo3::{
    exceptions::{PyTypeError, PyValueError},
    prelude::*,
    types::PyDict,
};

use crate::given::each;

/// One text, or a list of them.
fn texts(value: &Bound<'_, PyAny>) -> PyResult<Vec<String>> {
    each(value).iter().map(PyAnyMethods::extract).collect()
}

/// Options of reading: those of the command line, as keywords.
pub(crate) fn read_options(keywords: Option<&Bound<'_, PyDict>>) -> PyResult<ReadOptions> {
    let mut read = ReadOptions::default();
    let (mut from_s, mut to_s, mut hydraulics, mut into) = (None, None, None, JointKind::Turns);
    let selectors = |value: &Bound<'_, PyAny>| -> PyResult<Vec<Selector>> {
        Ok(texts(value)?.iter().map(|text| Selector::parse(text)).collect())
    };
    for (key, value) in keywords.into_iter().flatten() {
        if value.is_none() {
            continue;
        }
        match key.extract::<String>()?.as_str() {
            "planned" => read.planned = selectors(&value)?,
            "measured" => read.measured = selectors(&value)?,
            "joints" => read.joints = texts(&value)?,
            "time" => read.time_base = Some(clock(&value.extract::<String>()?)?),
            "slides" => {
                for text in texts(&value)? {
                    let (joint, unit) = LengthUnit::of_joint(&text).ok_or_else(|| {
                        PyTypeError::new_err(format!("slides: {text:?} is no joint, nor joint=mm, =cm or =m"))
                    })?;
                    read.slides.insert(joint, unit);
                }
            }
            "measured_delay_ms" => {
                let ms: f64 = value.extract()?;
                if !(-1e4..=1e4).contains(&ms) {
                    let expected = "expected a delay from -10000 to 10000 ms";
                    return Err(PyValueError::new_err(format!("measured_delay_ms is {ms}, {expected}")));
                }
                #[expect(clippy::cast_possible_truncation, reason = "bounded")]
                let ns = (1e6 * ms).round() as i64;
                read.measured_delay_ns = Some(ns);
            }
            "from_s" => from_s = Some(value.extract()?),
            "to_s" => to_s = Some(value.extract()?),
            "hydraulics" => hydraulics = Some(value.extract()?),
            "joints_as" => {
                into = match value.extract::<String>()?.as_str() {
                    "angles" => JointKind::Turns,
                    "cylinders" => JointKind::Slides,
                    other => {
                        let expected = "expected \"angles\" or \"cylinders\"";
                        return Err(PyValueError::new_err(format!("joints_as is {other:?}, {expected}")));
                    }
                }
            }
            "continuous" => read.continuous = texts(&value)?,
            "planned_degrees" => read.planned_in_degrees = value.extract()?,
            "measured_degrees" => read.measured_in_degrees = value.extract()?,
            role @ ("command" | "valve") => {
                let role = if role == "command" { SignalRole::Command } else { SignalRole::Valve };
                let topic = Some(Selector::parse(&value.extract::<String>()?));
                read.signals.push(WantedSignal { role, topic });
            }
            other => {
                let known = "planned, measured, command, valve, joints, time, slides, continuous, planned_degrees, \
                             measured_degrees, measured_delay_ms, from_s, to_s, hydraulics, joints_as";
                return Err(PyTypeError::new_err(format!("no option {other:?}; there are {known}")));
            }
        }
    }
    for (key, found) in [("from_s", from_s), ("to_s", to_s)] {
        if found.is_some_and(|s: f64| !s.is_finite()) {
            return Err(PyValueError::new_err(format!("{key} is {found:?}, expected seconds")));
        }
    }
    if into == JointKind::Slides && hydraulics.is_none() {
        return Err(PyValueError::new_err("joints_as asks for hydraulics, the file of the cylinders"));
    }
    read.range = TimeRange::of_seconds(from_s, to_s);
    read.cylinders = hydraulics.map(|file| Cylinders { file, into });
    Ok(read)
}

fn clock(text: &str) -> PyResult<TimeBase> {
    let all = [TimeBase::Header, TimeBase::Publish, TimeBase::Log];
    let found = all.into_iter().find(|clock| clock.name() == text);
    found.ok_or_else(|| {
        PyValueError::new_err(format!("time is {text:?}, expected \"header\", \"publish\" or \"log\""))
    })
}

/// A day or an instant, as text or as Python's own, in microseconds since 1970; UTC unless it says otherwise.
pub(crate) fn instant_us(value: &Bound<'_, PyAny>) -> PyResult<i64> {
    let datetime = value.py().import("datetime")?;
    let text = if value.hasattr("isoformat")? {
        value.call_method0("isoformat")?.to_string()
    } else {
        value.to_string()
    };
    let text = text.strip_suffix('Z').map_or_else(|| text.clone(), |text| format!("{text}+00:00"));
    let at = datetime.getattr("datetime")?.call_method1("fromisoformat", (&text,)).map_err(|_| {
        PyValueError::new_err(format!(
            "{text:?} is neither a day as 2026-03-01 nor an instant as 2026-03-01T12:00:00Z"
        ))
    })?;
    let utc = datetime.getattr("timezone")?.getattr("utc")?;
    let keywords = PyDict::new(value.py());
    keywords.set_item("tzinfo", &utc)?;
    let naive = at.getattr("tzinfo")?.is_none();
    let at = if naive { at.call_method("replace", (), Some(&keywords))? } else { at };
    let seconds: f64 = at.call_method0("timestamp")?.extract()?;
    #[expect(clippy::cast_possible_truncation, reason = "years have four digits")]
    Ok((seconds * 1e6).round() as i64)
}
