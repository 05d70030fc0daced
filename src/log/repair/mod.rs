//! Logs made from logs: what is whole of a damaged one, and one with a plan put into it.

mod copy;
mod join;
mod recover;

pub use join::{Addition, PlanSample};
pub use recover::{Recovered, recover};
