//! Studies of hydrotrace: how well the detector finds starts ([`detector`]), and what the evolutionary
//! algorithms reach on problems with known fronts ([`problems`]) and on tasks of the arm ([`tasks`]).
//!
//! The last two are one [`study`] over a [`Subject`](study::Subject): the same seeds, budgets, algorithms,
//! statistics, tables, curves and document.

pub mod detector;
pub mod learning;
pub mod problems;
#[cfg(test)]
#[allow(dead_code, reason = "the library has a use for each part")]
#[path = "../../../src/schema.rs"]
mod schema;
pub mod study;
pub mod tasks;
