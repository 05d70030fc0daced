//! Findings as one HTML page each, and as pictures: a summary first, plots that zoom, every table.
//!
//! A page is one file that fetches nothing. Markup is built by a macro that escapes whatever is put into it; data stand
//! in a block that is not run, and a policy in the head lets the page's own script and styles run and nothing else.

mod chart;
mod compared;
mod envelope;
mod figures;
mod fitted;
mod frame;
mod front;
mod joints;
mod paper;
mod parts;
mod planned;
mod run;
mod strip;
mod summary;
mod transitions;

pub use compared::compare_page;
pub use figures::{Figure, compare_figures, motion_figures, plan_figures, report_figures};
pub use planned::{judged_page, plan_page};
pub use run::report_page;

#[cfg(test)]
mod tests;
