//! Places in a file.

/// Bytes from `start` to before `end`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::log) struct Span {
    pub(in crate::log) start: u64,
    pub(in crate::log) end: u64,
}

impl Span {
    pub(in crate::log) fn length(self) -> u64 {
        self.end.saturating_sub(self.start)
    }

    /// The first bytes of it, `count` at most.
    pub(in crate::log) fn first(self, count: u64) -> Self {
        Self { end: self.end.min(self.start.saturating_add(count)), ..self }
    }
}
