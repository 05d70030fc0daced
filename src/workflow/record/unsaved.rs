//! When rows have waited for the disk too long, whatever the clock of the rows says.

use std::time::{Duration, Instant};

use super::Progress;

/// Rows wait for so long: a sender whose clock goes right is saved each second of it.
const LONGEST: Duration = Duration::from_millis(1500);

/// Since when rows wait.
#[derive(Debug)]
pub(super) struct Unsaved {
    since: Instant,
    rows: u64,
    bytes: u64,
}

impl Unsaved {
    pub(super) fn new() -> Self {
        Self { since: Instant::now(), rows: 0, bytes: 0 }
    }

    /// Whether rows came that have waited too long; then those so far count as saved.
    pub(super) fn is_due(&mut self, now: Progress) -> bool {
        let Self { since, rows, bytes } = self;
        if now.bytes != *bytes || now.rows == *rows {
            // What is handed to the system is so at a flush; without rows there is nothing to save.
            (*since, *rows, *bytes) = (Instant::now(), now.rows, now.bytes);
            return false;
        }
        let due = since.elapsed() > LONGEST;
        if due {
            (*since, *rows) = (Instant::now(), now.rows);
        }
        due
    }
}
