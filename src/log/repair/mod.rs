//! Logs made from logs: the whole messages of a damaged log, and a log with a plan added.

mod copy;
mod join;
mod recover;

pub use join::{Addition, PlanSample};
pub use recover::{Recovered, recover};
