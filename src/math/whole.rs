//! Counts from numbers.

/// Cut to a whole number; 0 below it and of no number.
#[inline]
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a cast saturates")]
pub fn whole(value: f64) -> usize {
    value as usize
}
