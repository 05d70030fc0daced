//! Tracking error of jointed arms, from their logs.
//!
//! hydrotrace reads planned and measured joint angles from MCAP logs, finds the instants at
//! which a joint is asked to leave rest (static-to-dynamic transitions), and says by how much
//! and how late the machine followed. See `ARCHITECTURE.md` for the layers.

// ground
pub mod atomic_file;
pub mod document;
pub mod math;
pub mod remark;
pub mod rng;
#[cfg(test)]
mod schema;
pub mod suggest;
pub mod units;

// nouns
pub mod arm;
pub use ::moea;
pub mod series;
pub mod spline;
pub mod task;

// abilities
pub mod fit;
pub mod log;
pub mod plan;
pub mod plant;
pub mod replay;

// workflow
pub mod workflow;

// edges
#[cfg(feature = "cli")]
pub mod cli;
#[cfg(feature = "cli")]
pub mod render;
#[cfg(feature = "viewer")]
pub mod viewer;
