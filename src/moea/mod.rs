//! Optimises several objectives at once, by evolution.

mod archive;
pub mod benchmark;
pub mod compare;
mod direction;
mod evaluate;
mod focus;
mod genetic;
pub mod indicator;
mod mating;
mod moead;
mod msops2;
mod normalize;
mod nsga2;
mod nsga3;
mod optimise;
mod population;
mod problem;
mod settings;
mod sorting;
mod survival;
mod variation;

pub use archive::Archive;
pub use direction::{Directions, MOST_DIRECTIONS, das_dennis, direction_count};
pub use focus::Focus;
pub use optimise::{Outcome, Progress, optimise, silent};
pub use population::Population;
pub use problem::{Bounds, Problem};
pub use settings::{Algorithm, Budget, MoeaError, Settings};
pub use sorting::{Sorting, dominates};
pub use variation::Operators;
