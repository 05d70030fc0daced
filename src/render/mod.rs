//! Renders what a workflow found, a file or folder of words a verb on one kit: text, Markdown, JSON, CSV, pages,
//! pictures. Nothing is computed here; degrees and milliseconds are.

pub mod compare;
mod contest;
pub mod demo;
pub mod excite;
pub mod fit;
pub mod import;
pub mod info;
pub mod join;
pub mod kit;
mod moea;
pub mod next;
pub mod plan;
pub mod recover;
pub mod replan;
pub mod report;
mod sample;
pub mod score;
pub mod simulate;
mod transition;

pub use contest::{contest_csv, contest_document, contest_json, contest_svg};
pub use moea::{curve_svg, curves_csv, front_csv, moea_document, moea_json};
