//! What was planned.

mod choices;
mod degrees;
mod figures;
mod front;
mod motion;
mod page;
mod rows;
mod tables;

pub(crate) use choices::Courses;
pub(super) use figures::front_figures;
pub(crate) use figures::{figures, motion_figures};
pub(super) use front::front;
pub(crate) use page::{judged_page, page};
pub use rows::limit_cell;
pub(crate) use tables::{broken_lines, ceiling_lines, document, judged_document};

use crate::{plan::Limit, text::fixed, units::degrees_from_radians};

/// A value of a limited quantity as people read it, with its unit.
pub(super) fn shown(limit: Limit, value: f64) -> String {
    let deg = degrees_from_radians(value);
    let (value, decimals, unit) = match limit {
        Limit::Position => (deg, 2, "deg"),
        Limit::Speed => (deg, 2, "deg/s"),
        Limit::Acceleration => (deg, 2, "deg/s2"),
        Limit::Jerk => (deg, 2, "deg/s3"),
        Limit::Torque => (value, 0, "N m"),
        Limit::RodSpeed => (value * 1e3, 1, "mm/s"),
        Limit::RodForce => (value / 1e3, 2, "kN"),
        Limit::PumpFlow => (value * 6e4, 1, "l/min"),
        Limit::ToolSpeed => (value, 3, "m/s"),
    };
    format!("{} {unit}", fixed(value, decimals))
}
