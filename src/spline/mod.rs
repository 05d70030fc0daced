//! Joint trajectories as B-splines through key points, with exact derivatives, extrema and integrals.
//!
//! The default is the sextic with knots at the mid-intervals: degree 6, C5, speed,
//! acceleration and jerk given at both ends. Knots at the key points, as a literal reading of
//! the paper's equation 2 has them, would leave its system one coefficient short.
//!
//! A [`Spline`] moves all the time; a [`Motion`] is a chain of splines with rests between.
//! Both own their buffers: giving new times allocates nothing.
//!
//! ```
//! use hydrotrace::spline::{Degree, Ends, KeyPoints, Quantity, Spline};
//!
//! let points = KeyPoints::new(2, vec![0.0, 0.0, 0.3, -0.1, 0.5, 0.2])?;
//! let mut spline = Spline::new(Degree::Sextic, points, &Ends::at_rest(2), &[0.0, 1.5, 3.0])?;
//! assert!((spline.at(1.5).of(Quantity::Position, 1)[0] + 0.1).abs() < 1e-12);
//! let fast = spline.peak(0, Quantity::Velocity);
//!
//! spline.retime(&[0.0, 3.0, 6.0])?;
//! assert!((spline.peak(0, Quantity::Velocity).value - fast.value / 2.0).abs() < 1e-12);
//! # Ok::<(), hydrotrace::spline::SplineError>(())
//! ```

mod basis;
mod bernstein;
mod error;
mod extrema;
mod knots;
mod motion;
mod points;
mod quadrature;
mod quantity;
mod sample;
mod slopes;
mod solve;
#[expect(clippy::module_inception, reason = "the type the module is named for")]
mod spline;

pub use error::SplineError;
pub use extrema::{Extrema, Extremum, Overshoot};
pub use knots::Degree;
pub use motion::{Dwell, Motion, Segment};
pub use points::{Ends, KeyPoints};
pub use quadrature::Gauss;
pub use quantity::Quantity;
pub use sample::Samples;
pub use slopes::{Place, WINDOW, Weights};
pub use spline::Spline;
