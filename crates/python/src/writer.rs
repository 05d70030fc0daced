//! `LogWriter`: a log that a control loop in Python writes.

use std::{
    collections::BTreeMap,
    fs::File,
    io::BufWriter,
    path::PathBuf,
    sync::{Mutex, PoisonError},
};

use hydrotrace::log::{self, Role, WriteOptions};
use pyo3::{exceptions::PyValueError, prelude::*};

use crate::error::{WriteError, raised};

type Writer = log::LogWriter<BufWriter<File>>;

/// Writes samples of one set of joints into an MCAP log of ROS 2 messages, as they come.
///
/// ``LogWriter("run.mcap", ["boom", "stick"])`` makes the file; one that is there is left alone. A killed process loses
/// at most the last second of stamps. Stamps are ns since 1970; values stand in the order of the joints, None is not
/// known. Use it in a ``with`` statement, or call ``close``.
#[pyclass(frozen, module = "hydrotrace_logs")]
pub(crate) struct LogWriter {
    /// `None` once it is closed.
    writer: Mutex<Option<Writer>>,
}

/// Numbers of a list, a tuple, an array; none of None.
fn numbers(values: Option<&Bound<'_, PyAny>>) -> PyResult<Vec<f64>> {
    let Some(values) = values else { return Ok(Vec::new()) };
    values.try_iter()?.map(|value| value?.extract()).collect()
}

impl LogWriter {
    fn with<T: Send>(
        &self,
        py: Python<'_>,
        write: impl FnOnce(&mut Writer) -> Result<T, log::WriteError> + Send,
    ) -> PyResult<T> {
        let written =
            py.detach(|| self.writer.lock().unwrap_or_else(PoisonError::into_inner).as_mut().map(write));
        match written {
            Some(written) => written.map_err(|error| raised::<WriteError>(py, &error)),
            None => Err(WriteError::new_err("the log is closed")),
        }
    }
}

#[pymethods]
impl LogWriter {
    #[new]
    fn new(py: Python<'_>, path: PathBuf, joints: Vec<String>) -> PyResult<Self> {
        let writer = Writer::create(&path, &joints, WriteOptions::live());
        let writer = writer.map_err(|error| raised::<WriteError>(py, &error))?;
        Ok(Self { writer: Mutex::new(Some(writer)) })
    }

    /// Writes where the joints should be ("planned"), are ("measured") or were sent ("command"): positions in rad, speeds
    /// in rad/s, torques in N m; of joints that slide m, m/s and N.
    #[pyo3(signature = (role, stamp_ns, position, velocity=None, effort=None))]
    fn joint_sample(
        &self,
        py: Python<'_>,
        role: &str,
        stamp_ns: i64,
        position: &Bound<'_, PyAny>,
        velocity: Option<&Bound<'_, PyAny>>,
        effort: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let role = match role {
            "planned" => Role::Planned,
            "measured" => Role::Measured,
            "command" => Role::Command,
            other => {
                let message = format!("role is {other:?}, expected \"planned\", \"measured\" or \"command\"");
                return Err(PyValueError::new_err(message));
            }
        };
        let [position, velocity, effort] = [numbers(Some(position))?, numbers(velocity)?, numbers(effort)?];
        self.with(py, |log| log.joint_sample(role, stamp_ns, &position, &velocity, &effort))
    }

    /// Writes named quantities of all joints, such as ``{"valve_command": [...], "cap_pressure_pa": [...]}``.
    fn interfaces(
        &self,
        py: Python<'_>,
        stamp_ns: i64,
        values: BTreeMap<String, Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let values: Vec<(String, Vec<f64>)> = values
            .into_iter()
            .map(|(name, values)| Ok((name, numbers(Some(&values))?)))
            .collect::<PyResult<_>>()?;
        self.with(py, |log| {
            let values: Vec<(&str, &[f64])> =
                values.iter().map(|(name, values)| (name.as_str(), values.as_slice())).collect();
            log.interfaces(stamp_ns, &values)
        })
    }

    /// Writes named texts: ``metadata("run", {"machine": "M07"})`` names the machine for ``report`` and ``scan``.
    fn metadata(&self, py: Python<'_>, name: &str, entries: BTreeMap<String, String>) -> PyResult<()> {
        self.with(py, |log| log.metadata(name, &entries))
    }

    /// Hands everything to the operating system: a process that is killed later loses nothing of it.
    fn flush(&self, py: Python<'_>) -> PyResult<()> {
        self.with(py, Writer::flush)
    }

    /// Ends the log. A second call does nothing.
    fn close(&self, py: Python<'_>) -> PyResult<()> {
        let ended = py.detach(|| {
            let writer = self.writer.lock().unwrap_or_else(PoisonError::into_inner).take();
            writer.map(Writer::finish)
        });
        ended.transpose().map(|_| ()).map_err(|error| raised::<WriteError>(py, &error))
    }

    fn __enter__(this: Py<Self>) -> Py<Self> {
        this
    }

    #[pyo3(signature = (*_error))]
    fn __exit__(&self, py: Python<'_>, _error: &Bound<'_, PyAny>) -> PyResult<()> {
        self.close(py)
    }
}
