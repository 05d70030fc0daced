//! One file per verb: what the caller wants in, what was found out. No printing, no clap.

pub mod detector;
pub mod export;
pub mod import;
pub mod info;
pub mod moea;
pub mod recover;
pub mod report;
pub mod simulate;
