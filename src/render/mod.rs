//! Renders what a workflow found, a file or folder of words a verb on one kit: text, Markdown, JSON, CSV, pages,
//! pictures. Nothing is computed here; degrees and milliseconds are.

pub(crate) mod compare;
pub(crate) mod demo;
pub(crate) mod excite;
pub(crate) mod export;
pub(crate) mod fit;
pub(crate) mod fleet;
pub(crate) mod import;
pub(crate) mod info;
pub(crate) mod join;
pub mod kit;
mod metric;
pub(crate) mod next;
pub mod plan;
mod promise;
pub(crate) mod record;
pub(crate) mod recover;
pub(crate) mod replan;
pub(crate) mod report;
pub(crate) mod simulate;
mod source;
pub(crate) mod watch;
