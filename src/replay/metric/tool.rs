//! The figures at the tool, in the order of their table.

use super::{
    Dimension::{Angle, Distance, Instant},
    Judged, Limit, Metric,
    Read::Number,
    Together::Nothing,
};
use crate::replay::ToolReplay;

type Row = Metric<ToolReplay>;

#[rustfmt::skip]
/// One row a figure.
pub static TOOL: &[Row] = &[
    Row::new("worst_m", "worst", "worst error of the tool", "Largest distance between the planned and the measured tool.", Distance, Number(|t| Some(t.worst.deviation.error_m)))
        .compared(Nothing)
        .limited(Judged::new(
            Limit::new("tool-error", "max-tool-error-mm", None, "error of the tool", "Largest distance of the tool from its plan; needs the arm (a URDF in the log, or given)", Distance),
            |_| true,
            |t| Some(t.worst.time_s),
        )),
    Row::new("worst_s", "at", "time of the worst error of the tool", "Time of that distance.", Instant, Number(|t| Some(t.worst.time_s))),
    Row::new("mean_m", "mean", "mean error of the tool", "Mean distance over the run.", Distance, Number(|t| Some(t.mean_m)))
        .compared(Nothing),
    Row::new("rms_m", "rms", "rms error of the tool", "Root mean square distance over the run.", Distance, Number(|t| Some(t.rms_m)))
        .compared(Nothing),
    Row::new("rms_along_m", "rms along", "rms error along the path", "The same of the part along the planned direction, while the plan moves the tool.", Distance, Number(|t| Some(t.split?.rms_along_m)))
        .compared(Nothing),
    Row::new("rms_across_m", "rms across", "rms error across the path", "The same of the part across the planned direction.", Distance, Number(|t| Some(t.split?.rms_across_m)))
        .compared(Nothing),
    Row::new("path_rms_m", "rms off path", "rms distance of the tool to its path", "Root mean square distance to the planned path, whatever the time.", Distance, Number(|t| Some(t.path_error?.rms)))
        .compared(Nothing),
    Row::new("path_worst_m", "worst off path", "worst distance of the tool to its path", "Largest distance to the planned path, whatever the time.", Distance, Number(|t| Some(t.path_error?.peak)))
        .compared(Nothing),
    Row::new("dwell_m", "at dwells", "worst error at a dwell", "Largest distance at which the tool stands while the plan rests between motions.", Distance, Number(|t| Some(t.worst_dwell()?.deviation.error_m)))
        .compared(Nothing),
    Row::new("end_m", "at the end", "error at rest at the end", "Distance at which the tool stands when the run ends.", Distance, Number(|t| Some(t.end()?.deviation.error_m)))
        .compared(Nothing)
        .limited(Judged::new(
            Limit::new("end-error", "max-end-error-mm", None, "error of the tool at rest at the end", "Largest distance of the tool from its plan where it rests when the run ends", Distance),
            |t| t.end().is_some(),
            |t| Some(t.end()?.to_s),
        )),
    Row::new("worst_orientation_rad", "worst angle", "worst error of the tool's orientation", "Largest angle between planned and measured orientation.", Angle, Number(|t| t.worst_orientation_rad))
        .compared(Nothing),
    Row::new("mean_orientation_rad", "mean angle", "mean error of the tool's orientation", "Mean of that angle.", Angle, Number(|t| t.mean_orientation_rad))
        .compared(Nothing),
    Row::new("rms_orientation_rad", "rms angle", "rms error of the tool's orientation", "Root mean square of that angle.", Angle, Number(|t| t.rms_orientation_rad))
        .compared(Nothing),
];
