//! Small numerics with no noun of the domain in them.

mod hermite;
mod jackknife;
mod levels;
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
pub use jackknife::jackknife;
pub use levels::{column_levels, row_weights, step_scatter, weighted_median};
pub use line::{Line, line};
pub use lowpass::lowpass;
pub use paired::{SignedRank, half_interval, signed_rank};
pub use pieces::{Piece, Pieces, pieces};
pub use programme::{Columns, quadratic_programme};
pub use sin_cos::sin_cos;
pub use statistic::{
    SIGMA_PER_MAD, deviation, dot, mad, mean, median, quantile, quantile_sorted, range, rms, usual_step,
};
pub use step::{Step, step};
pub use trend::{Trend, begins, false_discovery, theil_sen, trend};
pub use two_samples::{Difference, difference, pooled_difference};
pub use whole::whole;
