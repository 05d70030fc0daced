//! Logs made from logs: the whole messages of a damaged log, and a log with a plan added, and the files of one run.

mod copy;
mod gather;
mod join;
mod recover;

pub use join::{Addition, PlanSample};
pub use recover::{Recovered, recover};
