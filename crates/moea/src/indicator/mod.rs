//! How good a set of solutions is.

mod contribution;
mod distance;
mod hypervolume;

pub(crate) use contribution::Points;
pub use contribution::contributions;
pub use distance::{igd, igd_plus};
pub use hypervolume::hypervolume;
