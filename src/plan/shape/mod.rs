//! Plans whose shape is free beside their times: between the key points the curve passes free points, whose angles and
//! times are sought. They are as many as the control points that the key points leave free, and determine them.

mod aim;
mod curve;
mod descend;
mod factor;
mod found;
mod interior;
mod loads;
mod model;
mod pace;
mod point;
mod response;
mod row;
mod step;

#[cfg(test)]
mod laws;

pub use found::{MOST_PIECES, NoShape, Shape, fastest_shape, shape, smoother};
