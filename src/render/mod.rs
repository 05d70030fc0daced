//! Renders what a workflow found: text, Markdown, JSON, CSV, pages, pictures. Nothing is computed here; degrees
//! and milliseconds are.

mod compare;
mod contest;
mod csv;
mod demo;
mod excite;
mod fit;
mod import;
mod info;
mod join;
mod json;
mod markup;
mod method;
mod moea;
mod next;
mod page;
mod picture;
mod plan;
#[cfg(feature = "png")]
mod raster;
mod recover;
mod replan;
mod sample;
mod score;
mod simulate;
mod spark;
mod tables;
mod terminal_style;

pub use compare::{compare_gate_lines, compare_json, compare_parts};
pub use contest::{contest_csv, contest_json, contest_parts, contest_svg};
pub use csv::transitions_csv;
pub use demo::{Story, demo_parts};
pub use excite::excited_parts;
pub use fit::{fit_json, fit_parts, limits_toml};
pub use import::imported_parts;
pub use info::info_parts;
pub use join::joined_parts;
pub use json::report_json;
pub use markup::{Part, Sheet, markdown, noted, shown, text};
pub use moea::{curve_svg, curves_csv, front_csv, moea_json, moea_parts};
pub use next::{limits_written, next_written, plan_written};
pub use page::{
    Figure, compare_figures, compare_page, judged_page, motion_figures, plan_figures, plan_page,
    report_figures, report_page,
};
pub use plan::{broken_lines, ceiling_lines, judged_json, judged_parts, plan_json, plan_parts};
#[cfg(feature = "png")]
pub use raster::{Raster, raster};
pub use recover::recovered_parts;
pub use replan::{replan_json, replan_parts};
pub use score::{score_json, score_parts};
pub use simulate::simulated_line;
pub use tables::{gate_lines, report_parts};
pub use terminal_style::TerminalStyle;

use crate::units::degrees_from_radians;

/// Degrees with three decimals.
fn deg(rad: f64) -> String {
    let text = format!("{:.3}", degrees_from_radians(rad));
    if text == "-0.000" { "0.000".to_owned() } else { text }
}

/// Whole milliseconds.
fn ms(s: f64) -> String {
    let text = format!("{:.0}", s * 1e3);
    if text == "-0" { "0".to_owned() } else { text }
}

/// A cell for what is not there.
const NONE: &str = "-";

/// `one start`, `3 starts`.
fn counted(count: usize, noun: &str) -> String {
    if count == 1 { format!("one {noun}") } else { format!("{count} {noun}s") }
}
