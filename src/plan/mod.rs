//! Plans: objectives and limits of a timing of the key points, and the search for the best timings.
//!
//! A [`Setup`] is a task on its arm. An [`Evaluator`] gives the objectives of one timing and how
//! near it comes to every limit; [`Setup::margins`] says the same exactly, with the place.

mod checked;
mod choose;
mod command_margin;
mod descend;
mod error;
mod evaluate;
mod evaluation;
mod exact;
mod front;
mod goal;
mod joint_limits;
mod limit;
mod margin;
mod mesh;
mod near;
mod points;
mod polish;
mod posture;
mod problem;
mod quadratic;
mod reference;
mod sampled_motion;
mod search;
mod seed;
mod setup;
mod shape;
mod shares;
mod speed_room;
mod tangent;
mod via;

pub use choose::{Choice, HORIZON, NoChoice, Rule, choose, ends};
pub use command_margin::Interpolation;
pub use error::PlanError;
pub use evaluate::{Evaluator, Timing, excess};
pub use evaluation::PlanEvaluation;
pub use limit::{KEPT_SHARE, Limit, Margin};
pub use near::{MORE, bought, near};
pub use points::{BETWEEN, POINTS_HZ};
pub use problem::{Machine, NoMachine, TimingProblem};
pub use reference::{BEYOND, Reference};
pub use sampled_motion::SampledMotion;
pub use search::{Found, Phase, Progress, Search, search};
pub use seed::fastest;
pub use setup::Setup;
pub use shape::{MOST_PIECES, NoShape, Shape, fastest_shape, shape, smoother};
pub use speed_room::SpeedRoom;
pub use via::Via;
