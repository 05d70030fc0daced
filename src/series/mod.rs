//! Joint angles over time: what every reader yields and every ability works on.
//!
//! A [`Track`] is one joint of one source (planned or measured); a [`Pair`] is a plan laid
//! onto the measured stamps of the same joint. Times are seconds since the start of the log.

mod align;
mod clock;
mod derivative;
mod locate;
mod noise;
mod track;
mod trajectory;

pub use align::{Pair, align};
pub use clock::{Clock, continuous_clock};
pub use derivative::{LocalFit, local_quadratic};
pub use locate::{Located, locate};
pub use noise::{Noise, noise};
pub use track::{Series, Track, TrackError, split_at_gaps, velocity_agrees};
pub use trajectory::{PlannedPoint, PlannedTrajectory, plan_tracks};
