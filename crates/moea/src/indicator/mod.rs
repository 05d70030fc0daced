//! How good a set of solutions is.

mod distance;
mod hypervolume;

pub use distance::{igd, igd_plus};
pub use hypervolume::hypervolume;
