//! Signals over time: every reader yields them, every other module works on them.
//!
//! A [`Signal`] holds values of one [`Quantity`]; a [`Track`] is the position of one joint of one
//! source (planned or measured), rad if it turns, m if it slides; a [`Pair`] is a plan interpolated
//! to the measured stamps of the same joint. Times are seconds since the start of the log.

mod align;
mod clock;
mod derivative;
mod even;
mod frozen;
mod locate;
mod noise;
mod pose;
mod rest;
mod rounding;
#[cfg(test)]
mod sampled;
mod signal;
mod track;
mod trajectory;
mod whole;

pub use align::{Pair, align};
pub use clock::{Clock, continuous_clock};
pub use derivative::{LocalFit, each_local_quadratic, local_quadratic};
pub(crate) use even::even_instants;
pub use frozen::{frozen, seen};
pub use locate::{Located, left_at, locate};
pub use noise::{Noise, noise};
pub(crate) use noise::{is_sensed, over_window, white};
pub use pose::{PosePair, PoseSample};
pub use rest::whole_until_s;
pub(crate) use rounding::rounding;
pub(crate) use signal::{Instants, all_finite};
pub use signal::{JointKind, Quantity, Signal, SignalError};
pub use track::{Series, Track, split_at_gaps, velocity_agrees};
pub use trajectory::{PlannedPoint, PlannedTrajectory, plan_tracks};
pub use whole::Broken;
pub(crate) use whole::{bridged, moves_beside_s, moving_s};
