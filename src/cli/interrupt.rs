//! Ctrl-C: what was begun is taken away, or what is recorded is ended.

use std::sync::atomic::{AtomicBool, Ordering};

/// Whether a signal asks for an end in place of making one.
static ASK_ONLY: AtomicBool = AtomicBool::new(false);
static ASKED: AtomicBool = AtomicBool::new(false);

/// From now on the first signal to end only asks for an end; the second one ends.
pub(super) fn ask_only() {
    ASK_ONLY.store(true, Ordering::Relaxed);
}

/// Whether a signal asked for an end.
pub(super) fn is_asked() -> bool {
    ASKED.load(Ordering::Relaxed)
}

/// From now on a signal to end removes the files that are being written, then ends the process as it would have.
#[cfg(unix)]
pub(super) fn watch() {
    use signal_hook::{
        consts::{SIGINT, SIGTERM},
        iterator::Signals,
        low_level::emulate_default_handler,
    };
    // Where signals cannot be watched, the next run removes what is left.
    let Ok(mut signals) = Signals::new([SIGINT, SIGTERM]) else { return };
    std::thread::spawn(move || {
        for signal in signals.forever() {
            if ASK_ONLY.load(Ordering::Relaxed) && !ASKED.swap(true, Ordering::Relaxed) {
                continue;
            }
            crate::atomic_file::give_up();
            let _ = emulate_default_handler(signal);
        }
    });
}

/// Elsewhere the system ends the process; the next run removes what is left.
#[cfg(not(unix))]
pub(super) fn watch() {}
