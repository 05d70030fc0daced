//! What our logs carry beside samples: names, task, arm, provenance, schedule.

pub mod arm_log;
pub mod plan_log;
pub mod rest;
pub mod schedule;
pub mod series_log;
pub mod stamp;
