#![doc = include_str!("../README.md")]
//!
//! # The same on any number of cores
//!
//! All random numbers come from the seed, by one stream a purpose; evaluation draws none and is
//! collected by index. Equal settings give an equal [`Outcome`] on any number of cores, and on all machines whose
//! mathematical library rounds alike: powers, exponentials and cosines of the C library differ in their last digit
//! between processors with and without fused multiplication, and a run with them. A [`Record`] of the one may be
//! refused on the other.
//!
//! # Scale and origin
//!
//! Units of the objectives change nothing for NSGA-II, NSGA-III in all forms, AGE-MOEA-II, SMS-EMOA and normalised
//! MOEA/D: every threshold of theirs is relative, also to the origin. MOEA/D as published takes objectives as they are,
//! and MSOPS-II angles and distances between them: objectives of 1e-3 and 1e3 side by side are searched badly by both.
//!
//! # Departures from the paper
//!
//! * `DIFFERENCE(step 2)`: the focus operator compares signed distances to the reference plane
//!   among neighbouring directions, and acts on mating ([`Focus::Local`]). The printed reading
//!   ([`Focus::Literal`]) does not help: distance to the plane confounds convergence with the shape
//!   of the front. Nobody is ever barred from survival; that destroys diversity.
//! * `DIFFERENCE(step 2)`: where the front meets few of the reference directions, as a curve does
//!   among three objectives, the local focus alone loses: members at the ends are rarely in focus,
//!   and most places are refilled at random within niches. The default ([`Focus::Spread`]) leaves it
//!   with probability w = (1 - a)², a being the share of directions with a member: parents win
//!   tournaments by violation, front and crowding, and half of w takes the second parent from the
//!   ends of the front. Survival fills surplus places by crowding
//!   ([`Niching::filled_by_crowding`]). Where a is 1 nothing of this is drawn.
//! * `DIFFERENCE(step 2)`: while less than a tenth of the members is feasible, the local focus and its spread act
//!   in proportion to them, not at all if none is: infeasible members are ordered by violation, and a focus on the
//!   least of it loses all parts of the feasible region but the first that was met.
//! * `DIFFERENCE(step 3)`: the focus fades over the budget, with the square of the share used;
//!   without a budget it stays at one half.
//! * `DIFFERENCE(eq. 8, 9)`: the printed condition can hold only when all fitness values are
//!   equal, and then divides 0 by 0. The usual reading, the better of a pair against the mean,
//!   is available (`adaptive_rates`), and off.
//! * `DIFFERENCE(eq. 10)`: the sum goes over the reference points, by whose number it is
//!   divided, not over the population.
//! * `DIFFERENCE(fig. 3)`: the origin is no reference point for minimisation; hypervolumes are
//!   those of [`compare::Quality::hypervolume`].

mod agemoea2;
mod archive;
pub mod benchmark;
mod bounds;
pub mod compare;
mod crowding;
mod direction;
mod error;
mod evaluate;
mod focus;
mod genetic;
mod geometry;
pub mod indicator;
mod mating;
mod moead;
mod msops2;
mod named;
mod normalize;
mod nsga2;
mod nsga3;
mod optimise;
mod outcome;
mod population;
mod problem;
mod random;
mod record;
mod run;
mod settings;
mod smsemoa;
mod sorting;
mod state;
mod survival;
mod tolerance;
mod unsga3;
mod variables;
mod variation;

pub use agemoea2::Geodesic;
pub use archive::Archive;
pub use direction::{Directions, MOST_DIRECTIONS, das_dennis, direction_count};
pub use error::{MoeaError, Unsound};
pub use focus::Focus;
pub use mating::{Mating, MatingContext, Pair, Uniform};
pub use named::{ALGORITHMS, NamedAlgorithm};
pub use nsga2::{Crowding, Tournament};
pub use nsga3::Niching;
pub use optimise::{optimise, optimise_with, silent};
pub use outcome::{Outcome, Progress};
pub use population::Population;
pub use problem::{Bounds, Kind, Problem};
pub use random::Random;
pub use record::Record;
pub use run::Run;
pub use settings::{Algorithm, Budget, Settings};
pub use smsemoa::LeastContribution;
pub use sorting::{Sorting, dominates};
pub use survival::{Ranking, Survival};
pub use tolerance::Tolerance;
pub use unsga3::NicheTournament;
pub use variables::Variables;
pub use variation::Operators;
