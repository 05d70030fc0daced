//! Where and by how much an arm leaves its plan, and what to send next.
//!
//! hydrotrace reads planned and measured joints from logs (MCAP, ROS 2 bags), finds the instants at which a
//! joint is to leave rest (static-to-dynamic transitions), measures dead time and tracking error there, fits
//! each joint's closed loop, and computes plan and command of the next run. The whole loop:
//!
//! ```
//! use std::{collections::BTreeMap, ops::ControlFlow};
//! use hydrotrace::workflow::{fit, replan, report};
//!
//! let logs = vec!["sample-logs/task-1-run.mcap".into()];
//!
//! // Read the run and measure its tracking error.
//! let found = report::run(&report::Inputs { logs: logs.clone(), ..Default::default() })?;
//! for start in found.replay.transitions.iter().filter(|start| start.onset_delay_s > Some(0.3)) {
//!     println!("{} leaves {:.2} s late", start.joint, start.onset_delay_s.unwrap_or_default());
//! }
//!
//! // Fit the machine: what came of what was sent.
//! let machine = fit::run(&fit::Inputs { logs: logs.clone(), ..Default::default() })?;
//! assert!(machine.fit.joints.iter().all(|joint| joint.trusted()));
//!
//! // Plan the next run under what the machine has shown, with a command that anticipates its response.
//! let inputs = replan::Inputs { logs, keep_plan: true, ..Default::default() };
//! let next = replan::run(&inputs, |_evaluations| ControlFlow::Continue(()))?;
//!
//! // Write plan, command, task and arm as an MCAP log: here 100 samples a second.
//! let bytes = next.log(BTreeMap::new(), 100.0)?;
//! assert!(bytes.starts_with(b"\x89MCAP0\r\n"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Where to begin
//!
//! | to | use |
//! |---|---|
//! | read a log into series | [`log::read_recording`] |
//! | write a log from a control loop | [`log::LogWriter`] |
//! | measure tracking error of series in memory | [`series::align`], [`replay::replay`] |
//! | fit series in memory | [`fit::fit`] |
//! | plan a task | [`workflow::plan::run`] |
//! | do what a verb of the program does | [`workflow`]: a folder a verb |
//! | optimise a problem of your own | [`moea::optimise`] |
//!
//! Angles are radians, lengths metres; every other quantity has its SI unit in its name. Doubts about data
//! are [`remark::Remarks`] in the findings; errors are enums with numbers in their fields. Equal inputs, seed
//! and build give equal bytes on any number of threads. `ARCHITECTURE.md` shows the layers.
//!
//! # Features
//!
//! `cli` (default) is the program; the library without features knows no terminal, page or plot. It has
//! `encodings`, which reads tables of old programs, `parquet`, which reads and writes such tables, and `sqlite`, which reads
//! bags of that kind. Beside it, `cloud` reads logs in object stores, `png` draws figures as pixels, and `viewer` shows runs in
//! Rerun.

// Hidden: for the program, its tests and studies, without a promise.

// ground
#[doc(hidden)]
pub mod atomic_file;
#[doc(hidden)]
pub mod document;
#[doc(hidden)]
pub mod input_file;
#[doc(hidden)]
pub mod math;
pub mod remark;
#[doc(hidden)]
pub mod rng;
#[cfg(test)]
mod schema;
mod suggest;
mod text;
#[doc(hidden)]
pub mod threads;
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
#[doc(hidden)]
pub mod cli;
#[cfg(feature = "cli")]
#[doc(hidden)]
pub mod render;
#[cfg(feature = "viewer")]
mod viewer;
