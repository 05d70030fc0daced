//! Logs as callers give them: paths, bytes, file objects.

use std::{io, path::PathBuf, sync::Mutex, sync::PoisonError};

use hydrotrace::log::{Input, ReadAt};
use pyo3::{
    exceptions::PyTypeError,
    prelude::*,
    pybacked::PyBackedBytes,
    types::{PyBytes, PyList, PyTuple},
};
use tempfile::TempDir;

use crate::work::may_call_python;

/// What bytes without a name are called.
const NAMELESS: &str = "log.mcap";

/// Bytes that Python holds, read without a copy of all of them.
#[derive(Debug)]
struct Held(PyBackedBytes);

impl ReadAt for Held {
    fn length(&self) -> io::Result<u64> {
        Ok(self.0.len() as u64)
    }

    fn read_at(&self, into: &mut [u8], at: u64) -> io::Result<usize> {
        let rest = usize::try_from(at).ok().and_then(|at| self.0.get(at..)).unwrap_or_default();
        let count = rest.len().min(into.len());
        into[..count].copy_from_slice(&rest[..count]);
        Ok(count)
    }
}

/// An object with `read` and `seek`. Its place belongs to one read at a time.
#[derive(Debug)]
struct FileObject {
    object: Py<PyAny>,
    length: u64,
    place: Mutex<()>,
}

impl ReadAt for FileObject {
    fn length(&self) -> io::Result<u64> {
        Ok(self.length)
    }

    fn read_at(&self, into: &mut [u8], at: u64) -> io::Result<usize> {
        let _place = self.place.lock().unwrap_or_else(PoisonError::into_inner);
        let read = |py: Python<'_>| -> PyResult<usize> {
            let object = self.object.bind(py);
            object.call_method1("seek", (at,))?;
            let bytes: PyBackedBytes = object.call_method1("read", (into.len(),))?.extract()?;
            let count = bytes.len().min(into.len());
            into[..count].copy_from_slice(&bytes[..count]);
            Ok(count)
        };
        if !may_call_python() {
            return Err(io::Error::other("the call was interrupted"));
        }
        match Python::try_attach(read) {
            Some(Ok(count)) => Ok(count),
            Some(Err(error)) => Err(io::Error::other(error.to_string())),
            None => Err(io::Error::other("Python has ended")),
        }
    }
}

fn is_bytes(object: &Bound<'_, PyAny>) -> bool {
    let name = object.get_type().name().map(|name| name.to_string()).unwrap_or_default();
    ["bytes", "bytearray", "memoryview"].contains(&name.as_str())
}

fn of_bytes(object: &Bound<'_, PyAny>, name: Option<String>) -> PyResult<Input> {
    let object = match object.cast::<PyBytes>() {
        Ok(bytes) => bytes.clone(),
        // A copy: what can change while it is read is not read.
        Err(_) => object.py().get_type::<PyBytes>().call1((object,))?.cast_into()?,
    };
    let name = name.unwrap_or_else(|| NAMELESS.to_owned());
    Ok(Input::Reader { name, reader: Box::new(Held(object.into())) })
}

fn of_file(object: &Bound<'_, PyAny>, name: Option<String>) -> PyResult<Input> {
    let length = object.call_method1("seek", (0, 2))?;
    let length = if length.is_none() { object.call_method0("tell")? } else { length };
    let own = || object.getattr("name").and_then(|name| name.extract::<String>()).ok();
    let name = name.or_else(own).unwrap_or_else(|| NAMELESS.to_owned());
    let reader =
        FileObject { object: object.clone().unbind(), length: length.extract()?, place: Mutex::new(()) };
    Ok(Input::Reader { name, reader: Box::new(reader) })
}

/// One log: a path, bytes, or an object with `read` and `seek`.
pub(crate) fn input(object: &Bound<'_, PyAny>, name: Option<String>) -> PyResult<Input> {
    if is_bytes(object) {
        return of_bytes(object, name);
    }
    if object.hasattr("read")? && object.hasattr("seek")? {
        return of_file(object, name);
    }
    match object.extract::<PathBuf>() {
        Ok(path) => Ok(Input::Path(path)),
        Err(_) => Err(PyTypeError::new_err(format!(
            "expected a path, bytes or a file object, not {}",
            object.get_type().name()?
        ))),
    }
}

/// The objects of a list or tuple; another object is a list of its own.
pub(crate) fn each<'py>(object: &Bound<'py, PyAny>) -> Vec<Bound<'py, PyAny>> {
    match (object.cast::<PyList>(), object.cast::<PyTuple>()) {
        (Ok(list), _) => list.iter().collect(),
        (_, Ok(tuple)) => tuple.iter().collect(),
        _ => vec![object.clone()],
    }
}

/// The log of a call: given in its place, or as `data`.
pub(crate) fn inputs(
    log: Option<&Bound<'_, PyAny>>,
    data: Option<&Bound<'_, PyAny>>,
    name: Option<String>,
) -> PyResult<Vec<Input>> {
    match (log, data) {
        (Some(log), None) => each(log).iter().map(|part| input(part, name.clone())).collect(),
        (None, Some(data)) => Ok(vec![input(data, name)?]),
        _ => Err(PyTypeError::new_err("give either a log or data=")),
    }
}

/// Logs as files. What is in memory is written into a folder that lasts as long as this does.
#[derive(Debug)]
pub(crate) struct Files {
    pub(crate) paths: Vec<PathBuf>,
    _folder: Option<TempDir>,
}

impl Files {
    /// Of one log, or of several in a list.
    pub(crate) fn of(logs: &Bound<'_, PyAny>) -> PyResult<Self> {
        let (mut paths, mut folder) = (Vec::new(), None);
        for (k, log) in each(logs).iter().enumerate() {
            match input(log, None)? {
                Input::Path(path) => paths.push(path),
                Input::Bytes { name, data } => paths.push(kept(&mut folder, k, &name, &data)?),
                Input::Reader { name, reader } => {
                    let mut data = vec![0; usize::try_from(reader.length()?)?];
                    let mut filled = 0;
                    while filled < data.len() {
                        match reader.read_at(&mut data[filled..], filled as u64)? {
                            0 => break,
                            count => filled += count,
                        }
                    }
                    paths.push(kept(&mut folder, k, &name, &data[..filled])?);
                }
            }
        }
        Ok(Self { paths, _folder: folder })
    }
}

fn kept(folder: &mut Option<TempDir>, k: usize, name: &str, data: &[u8]) -> PyResult<PathBuf> {
    let folder = if let Some(folder) = folder { folder } else { folder.insert(tempfile::tempdir()?) };
    let name = PathBuf::from(name).file_name().map_or_else(|| NAMELESS.into(), ToOwned::to_owned);
    let own = folder.path().join(k.to_string());
    std::fs::create_dir(&own)?;
    std::fs::write(own.join(&name), data)?;
    Ok(own.join(name))
}
