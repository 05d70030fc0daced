//! One file per verb: what the caller wants in, what was found out. No printing, no clap.

pub mod arm_log;
pub mod compare;
pub mod contest;
pub mod detector;
pub mod excite;
pub mod export;
pub mod fit;
pub mod import;
pub mod info;
pub mod moea;
pub mod observe;
pub mod plan;
pub mod plan_log;
pub mod recover;
pub mod replan;
pub mod report;
mod sample;
pub mod schedule;
pub mod series_log;
pub mod simulate;
pub mod simulate_log;
pub mod view;
