//! The words of a report.

mod answer;
mod crowd;
mod csv;
mod figures;
mod first;
mod frequency;
mod joints;
mod method;
mod page;
mod resting;
mod signals;
mod steps;
mod summary;
mod tables;
#[cfg(test)]
mod tests;
mod tiles;
mod together;
mod tool;
mod tool_page;
mod why;
mod windows;

pub(crate) use answer::answer;
pub(crate) use csv::csv;
pub(crate) use figures::figures;
pub(crate) use page::{name, page};
pub(crate) use tables::{document, verdicts};
