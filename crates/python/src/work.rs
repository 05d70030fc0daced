//! What takes time runs on a thread of its own. Meanwhile other Python threads run, and Ctrl-C is looked for.
//!
//! No thread outlives its call but one whose call was interrupted: a process may fork between calls.

use std::{
    any::Any,
    panic::{AssertUnwindSafe, catch_unwind},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
        mpsc::{Receiver, RecvTimeoutError, sync_channel},
    },
    thread,
    time::{Duration, Instant},
};

use pyo3::prelude::*;

use crate::error::HydrotraceError;

/// How often Ctrl-C is looked for.
const LOOK: Duration = Duration::from_millis(50);
/// How long work that was told to end may take for that.
const END: Duration = Duration::from_secs(30);

/// Tells work that it is to end.
#[derive(Debug, Clone, Default)]
pub(crate) struct Stop(Arc<AtomicBool>);

impl Stop {
    pub(crate) fn is_set(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

type Caught<T> = Result<T, Box<dyn Any + Send>>;

/// Does some work and waits for it. A signal sets `stop` and raises what Python makes of it, when the work has ended if
/// it looks at `stop`, and at once if it does not. A panic becomes an exception.
pub(crate) fn run<T: Send + 'static>(
    py: Python<'_>,
    stop: Option<&Stop>,
    work: impl FnOnce() -> T + Send + 'static,
) -> PyResult<T> {
    let (done, mut receiver) = sync_channel(1);
    let work = move || {
        // Nobody waits for it any more after a signal.
        let _ = done.send(catch_unwind(AssertUnwindSafe(work)));
    };
    thread::Builder::new().name("hydrotrace".to_owned()).spawn(work)?;
    let mut interrupted: Option<(PyErr, Instant)> = None;
    loop {
        let waiting = move || -> (Receiver<Caught<T>>, Result<Caught<T>, RecvTimeoutError>) {
            let found = receiver.recv_timeout(LOOK);
            (receiver, found)
        };
        let (back, found) = py.detach(waiting);
        receiver = back;
        match (found, interrupted.take()) {
            (Err(RecvTimeoutError::Timeout), None) => {
                if let Err(signal) = py.check_signals() {
                    let Some(stop) = stop else { return Err(signal) };
                    stop.0.store(true, Ordering::Relaxed);
                    interrupted = Some((signal, Instant::now()));
                }
            }
            (Err(RecvTimeoutError::Timeout), Some((signal, since))) => {
                py.check_signals()?;
                if since.elapsed() > END {
                    return Err(signal);
                }
                interrupted = Some((signal, since));
            }
            (_, Some((signal, _))) => return Err(signal),
            (Ok(Ok(value)), None) => return Ok(value),
            (Ok(Err(panic)), None) => return Err(HydrotraceError::new_err(told(&*panic))),
            (Err(RecvTimeoutError::Disconnected), None) => {
                return Err(HydrotraceError::new_err("the work ended without a result"));
            }
        }
    }
}

/// What a panic says.
pub(crate) fn told(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    let text = text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("it does not say why");
    format!("hydrotrace failed where it should not: {text}; please report this")
}

/// Does some work on threads that end with it; 0 threads are one a core.
pub(crate) fn on_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    match rayon::ThreadPoolBuilder::new().num_threads(threads).build() {
        Ok(pool) => pool.install(work),
        // Without threads the calling one has to do.
        Err(_) => hydrotrace::threads::alone(work),
    }
}
