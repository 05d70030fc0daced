//! What was planned.

mod broken;
mod choices;
mod degrees;
mod figures;
mod front;
mod motion;
mod page;
mod rows;
mod tables;

pub(crate) use broken::{broken_lines, ceiling_lines};
pub(crate) use choices::Courses;
pub(super) use figures::front_figures;
pub(crate) use figures::{figures, motion_figures};
pub(super) use front::front;
pub(crate) use page::{judged_page, page};
pub use rows::limit_cell;
pub(crate) use tables::{document, judged_document};

use crate::{plan::Limit, series::JointKind, text::fixed, units::degrees_from_radians};

/// A value of a limited quantity of a joint of a kind as people read it, with its unit.
pub(super) fn shown(limit: Limit, kind: JointKind, value: f64) -> String {
    let slides = kind == JointKind::Slides;
    let (of_joint, decimals) = if slides { (1e3 * value, 1) } else { (degrees_from_radians(value), 2) };
    let unit = |turns: &'static str, slid: &'static str| if slides { slid } else { turns };
    let (value, decimals, unit) = match limit {
        Limit::Position => (of_joint, decimals, unit("deg", "mm")),
        Limit::Speed => (of_joint, decimals, unit("deg/s", "mm/s")),
        Limit::Acceleration => (of_joint, decimals, unit("deg/s2", "mm/s2")),
        Limit::Jerk => (of_joint, decimals, unit("deg/s3", "mm/s3")),
        Limit::Torque => (value, usize::from(value.abs() < 200.0), unit("N m", "N")),
        Limit::RodSpeed => (value * 1e3, 1, "mm/s"),
        Limit::RodForce => (value / 1e3, 2, "kN"),
        Limit::PumpFlow => (value * 6e4, 1, "l/min"),
        Limit::ToolSpeed => (value, 3, "m/s"),
    };
    format!("{} {unit}", fixed(value, decimals))
}
