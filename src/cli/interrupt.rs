//! Ctrl-C: what was begun is taken away.

use std::thread;

use signal_hook::{
    consts::{SIGINT, SIGTERM},
    iterator::Signals,
    low_level::emulate_default_handler,
};

use crate::atomic_file::give_up;

/// From now on a signal to end removes the files that are being written, then ends the process as it would have.
pub(super) fn watch() {
    // Where signals cannot be watched, the next run removes what is left.
    let Ok(mut signals) = Signals::new([SIGINT, SIGTERM]) else { return };
    thread::spawn(move || {
        for signal in signals.forever() {
            give_up();
            let _ = emulate_default_handler(signal);
        }
    });
}
