//! Ctrl-C, or a terminal that is closed: what was begun is taken away, or what is recorded is ended.

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
        consts::{SIGHUP, SIGINT, SIGTERM},
        iterator::Signals,
        low_level::emulate_default_handler,
    };
    // Where signals cannot be watched, the next run removes what is left.
    let ends = [SIGINT, SIGTERM].into_iter().chain((!ignores_hang_ups()).then_some(SIGHUP));
    let Ok(mut signals) = Signals::new(ends) else { return };
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

/// Whether the process was begun to outlive its terminal, as `nohup` does, by what Linux says of it; so it is taken elsewhere.
#[cfg(unix)]
fn ignores_hang_ups() -> bool {
    let status = crate::input_file::read_to_string("/proc/self/status".as_ref()).unwrap_or_default();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    // SIGHUP is the first of the signals.
    ignored.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).is_none_or(|mask| mask & 1 == 1)
}

/// Elsewhere the system ends the process; the next run removes what is left.
#[cfg(not(unix))]
pub(super) fn watch() {}
