//! Small numerics with no noun of the domain in them.

mod hermite;
mod line;
mod lowpass;
mod paired;
mod pieces;
mod programme;
mod sin_cos;
mod statistic;
mod step;
mod trend;
mod two_samples;
mod whole;

pub use hermite::{State, cubic, linear, quintic, smooth_step};
pub use line::{Line, line};
pub use lowpass::lowpass;
pub use paired::{SignedRank, half_interval, signed_rank};
pub use pieces::{Piece, Pieces, pieces};
pub use programme::{Columns, quadratic_programme};
pub use sin_cos::sin_cos;
pub use statistic::{
    SIGMA_PER_MAD, deviation, dot, mad, mean, median, quantile, quantile_sorted, range, usual_step,
};
pub use step::{Step, step};
pub use trend::{
    Trend, begins, column_levels, false_discovery, row_weights, step_scatter, theil_sen, trend,
    weighted_median,
};
pub use two_samples::{Difference, difference};
pub use whole::whole;
