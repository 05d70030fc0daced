//! What must not allocate: steps of a control loop, of a search, of a simulation.

mod log_write;
mod plan;
mod plant;
mod spline;
