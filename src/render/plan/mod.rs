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

use crate::{plan::Limit, units::degrees_from_radians};

/// A value of a limited quantity as people read it, with its unit.
pub(super) fn shown(limit: Limit, value: f64) -> String {
    match limit {
        Limit::Position => format!("{:.2} deg", degrees_from_radians(value)),
        Limit::Speed => format!("{:.2} deg/s", degrees_from_radians(value)),
        Limit::Acceleration => format!("{:.2} deg/s2", degrees_from_radians(value)),
        Limit::Jerk => format!("{:.2} deg/s3", degrees_from_radians(value)),
        Limit::Torque => format!("{value:.0} N m"),
        Limit::RodSpeed => format!("{:.1} mm/s", value * 1e3),
        Limit::RodForce => format!("{:.2} kN", value / 1e3),
        Limit::PumpFlow => format!("{:.1} l/min", value * 6e4),
        Limit::ToolSpeed => format!("{value:.3} m/s"),
    }
}
