//! What was planned again.

mod checks;
mod joints;
mod learning;
mod limits;
mod page;
mod tables;

pub(crate) use page::page;
pub(crate) use tables::document;
