//! The words of a report.

mod csv;
mod figures;
mod joints;
mod method;
mod page;
mod summary;
mod tables;
#[cfg(test)]
mod tests;
mod tiles;

pub(crate) use csv::csv;
pub(crate) use figures::figures;
pub(crate) use page::page;
pub(crate) use tables::{document, verdicts};
