//! Plans: what a timing of the key points costs, what it must keep to, and the best timings.
//!
//! A [`Setup`] is a task on its arm. An [`Evaluator`] gives the objectives of one timing and how
//! near it comes to every limit; [`Setup::margins`] says the same exactly, with the place.

mod error;
mod evaluate;
mod limit;
mod margin;
mod mesh;
mod setup;

pub use error::PlanError;
pub use evaluate::{Evaluator, Objectives};
pub use limit::{Limit, Margin};
pub use setup::Setup;
