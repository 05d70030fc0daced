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

pub use csv::csv;
pub use figures::figures;
pub use page::page;
pub use tables::{document, verdicts};
