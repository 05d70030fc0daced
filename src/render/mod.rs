//! Renders what a workflow found, a file or folder of words a verb on one kit: text, Markdown, JSON, CSV, pages,
//! pictures. Nothing is computed here; degrees and milliseconds are.

pub mod compare;
pub mod demo;
pub mod excite;
pub mod fit;
pub mod import;
pub mod info;
pub mod join;
pub mod kit;
mod metric;
pub mod next;
pub mod plan;
pub mod recover;
pub mod replan;
pub mod report;
pub mod simulate;
