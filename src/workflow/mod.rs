//! A folder a verb: what the caller wants in, what was found out. No printing, no clap.

pub mod carried;
pub mod compare;
pub mod excite;
pub mod export;
pub mod fit;
#[cfg(feature = "parquet")]
pub mod fleet;
mod idle_bound;
pub mod import;
pub mod info;
pub mod join;
mod leads;
mod names;
pub mod plan;
pub mod record;
pub mod recover;
pub mod replan;
pub mod report;
mod same_plan;
pub mod simulate;
#[doc(hidden)]
pub mod view;
#[cfg(feature = "parquet")]
pub mod watch;
