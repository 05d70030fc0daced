//! `fleet`: many logs of many machines become one dataset, and the dataset answers which machine drifts, since when,
//! and whether a repair helped.
//!
//! The dataset is a folder of Parquet tables that any engine reads: `runs`, one row a log; `joints`, one row a run and
//! joint; `transitions`, one row a start or reversal; `remarks`; `limits`, what a fit finds in each run; `interventions`. Its files say nothing of when they were made: equal logs
//! give equal bytes.

mod alike;
mod arrange;
mod blocks;
mod by_day;
mod common;
mod compact;
mod course;
mod dated;
mod document;
mod doubts;
mod drift;
mod effect;
mod failure;
mod found;
mod gate;
mod history;
mod joint_trend;
mod judged;
#[cfg(test)]
mod laws;
mod leveled;
mod limits;
mod link;
mod machine;
mod map;
mod note;
mod once;
mod one_way;
mod other_joints;
mod own_change;
mod renamed;
mod run;
mod scan;
mod sensed;
mod sides;
mod sources;
mod stepped;
mod store;
mod tables;
mod trended;
mod when;
mod window;
mod within;
mod worst;

pub use alike::Alike;
pub use compact::{Compacted, compact};
pub use course::Change;
pub(in crate::workflow) use dated::began_ns;
pub use document::{Failure, Scanned};
pub use drift::{Drift, drift};
pub use effect::{Effect, JointEffect, effect, effect_of_last_note};
pub use failure::FleetFailure;
pub use gate::{Gate, GateResult, Gated, gate};
pub use history::{By, Filter};
pub use joint_trend::{JointTrend, Level};
pub use machine::MachineFrom;
pub use map::{Cell as MapCell, Map, MapRow};
pub use note::{Intervention, Note, Notes, note, notes, take_back};
pub(super) use scan::{Analysed, Beside, scan_these};
pub use scan::{Inputs, Progress, own_analysis_id, scan};
pub(super) use sources::{Source, sources_now};
pub use stepped::LevelStep;
pub use tables::{Log, Name as TableName, Rows, analysed as rows, failed as failed_rows};
pub use worst::{Worst, WorstJoint, worst};
