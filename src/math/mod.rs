//! Small numerics with no noun of the domain in them.

mod hermite;
mod statistic;

pub use hermite::{State, cubic, linear, quintic};
pub use statistic::{mad, median, quantile, quantile_sorted};
