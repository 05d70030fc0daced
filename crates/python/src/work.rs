//! What takes time runs on a thread of its own. Meanwhile other Python threads run, and Ctrl-C is looked for.
//!
//! No thread outlives its call but one whose call was interrupted: a process may fork between calls.

use std::{
    any::Any,
    cell::RefCell,
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
pub(crate) struct Stop(Arc<Told>);

#[derive(Debug, Default)]
struct Told {
    stops: AtomicBool,
    /// Whether the work calls Python, which must not end meanwhile.
    calls_python: AtomicBool,
}

impl Stop {
    pub(crate) fn is_set(&self) -> bool {
        self.0.stops.load(Ordering::SeqCst)
    }

    fn set(&self) {
        self.0.stops.store(true, Ordering::SeqCst);
    }
}

thread_local! {
    static OWN: RefCell<Option<Stop>> = const { RefCell::new(None) };
}

/// Whether the work on this thread may still call Python; it is waited for from then on.
pub(crate) fn may_call_python() -> bool {
    OWN.with_borrow(|own| {
        own.as_ref().is_none_or(|own| {
            own.0.calls_python.store(true, Ordering::SeqCst);
            !own.is_set()
        })
    })
}

type Caught<T> = Result<T, Box<dyn Any + Send>>;

/// Does some work and waits for it. A signal sets `stop` and raises what Python makes of it, when the work has ended if
/// it looks at `stop` or calls Python, and at once if it does not. A panic becomes an exception.
pub(crate) fn run<T: Send + 'static>(
    py: Python<'_>,
    stop: Option<&Stop>,
    work: impl FnOnce() -> T + Send + 'static,
) -> PyResult<T> {
    let (done, mut receiver) = sync_channel(1);
    let (looks, stop) = (stop.is_some(), stop.cloned().unwrap_or_default());
    let own = stop.clone();
    let work = move || {
        OWN.set(Some(own));
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
                    stop.set();
                    if !looks && !stop.0.calls_python.load(Ordering::SeqCst) {
                        return Err(signal);
                    }
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

/// More threads than this only wait for each other.
const MOST_THREADS: usize = 256;

/// Does some work on threads that end with it; 0 threads are one a core.
pub(crate) fn on_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    match rayon::ThreadPoolBuilder::new().num_threads(threads.min(MOST_THREADS)).build() {
        Ok(pool) => pool.install(work),
        // Without threads the calling one has to do.
        Err(_) => hydrotrace::threads::alone(work),
    }
}
