//! How far bounds may lie.

/// Largest size of a bound: sums and spreads of values within are numbers.
pub(super) const FARTHEST: f64 = 1e300;

/// Largest size of an integer: all below are numbers, and so are their halves.
pub(super) const LARGEST_INTEGER: f64 = 1e15;
