//! Instants as messages and logs carry them.

use super::{WriteError, cdr::Cdr};

const NS_PER_S: i64 = 1_000_000_000;

/// An instant that fits both `builtin_interfaces/Time` and an MCAP time stamp.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stamp {
    seconds: i32,
    nanoseconds: u32,
    /// When it counts as received, ns.
    pub(super) log_time_ns: u64,
}

impl Stamp {
    pub(super) fn new(stamp_ns: i64, log_delay_ns: i64) -> Result<Self, WriteError> {
        let (seconds, nanoseconds) = split(stamp_ns, "stamp")?;
        let received = stamp_ns.checked_add(log_delay_ns).and_then(|ns| u64::try_from(ns).ok());
        let log_time_ns = received.ok_or(WriteError::TimeRange { quantity: "stamp", value_ns: stamp_ns })?;
        Ok(Self { seconds, nanoseconds, log_time_ns })
    }

    /// No stamp: the times of the message count from its receipt.
    pub(super) fn unset(received_ns: i64) -> Result<Self, WriteError> {
        Ok(Self { seconds: 0, nanoseconds: 0, ..Self::new(received_ns, 0)? })
    }

    pub(super) fn encode(self, cdr: &mut Cdr) {
        cdr.i32(self.seconds);
        cdr.u32(self.nanoseconds);
    }
}

/// `builtin_interfaces/Duration`.
pub(super) fn encode_duration(cdr: &mut Cdr, duration_ns: i64) -> Result<(), WriteError> {
    let (seconds, nanoseconds) = split(duration_ns, "time from start")?;
    cdr.i32(seconds);
    cdr.u32(nanoseconds);
    Ok(())
}

/// Whole seconds rounded down, and the nanoseconds beyond them.
#[expect(clippy::cast_possible_truncation, reason = "a remainder lies in 0..1e9")]
fn split(value_ns: i64, quantity: &'static str) -> Result<(i32, u32), WriteError> {
    let seconds = i32::try_from(value_ns.div_euclid(NS_PER_S))
        .map_err(|_| WriteError::TimeRange { quantity, value_ns })?;
    Ok((seconds, value_ns.rem_euclid(NS_PER_S) as u32))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn negative_durations_round_down_and_keep_positive_nanoseconds() {
        assert_eq!(split(-1, "").unwrap(), (-1, 999_999_999));
        assert_eq!(split(-NS_PER_S, "").unwrap(), (-1, 0));
    }

    #[test]
    fn instants_before_1970_or_after_2038_are_refused() {
        assert!(matches!(Stamp::new(-1, 0), Err(WriteError::TimeRange { value_ns: -1, .. })));
        let last_ns = i64::from(i32::MAX) * NS_PER_S + 999_999_999;
        assert!(Stamp::new(last_ns, 0).is_ok());
        assert!(Stamp::new(last_ns + 1, 0).is_err());
    }
}
