//! The figures of a joint over the whole run, in the order of its table.

use super::{
    Dimension::{Acceleration, Correlation, Count, Duration, Instant, Position, Share, Speed, Word},
    Judged, Limit, Metric,
    Read::{Number, Word as Text},
    Together::{Mean, Most, Rms, Whole},
};
use crate::replay::JointReplay;

type Row = Metric<JointReplay>;

#[rustfmt::skip]
/// One row a figure.
pub static JOINT: &[Row] = &[
    Row::new("joint", "joint", "joint", "Name of the joint.", Word, Text(|j| j.name.clone())),
    Row::new("rms", "rms", "rms error", "Root mean square tracking error, weighted by time.", Position, Number(|j| Some(j.tracking_error.rms)))
        .compared(Rms(|j| Some(j.tracking_error)))
        .limited(Judged::new(
            Limit::new("rms", "max-rms-deg", Some("max-rms-mm"), "rms error", "Largest RMS error of a joint over the run", Position),
            |_| true,
            |j| Some(j.tracking_error.peak_time_s),
        )),
    Row::new("mean_abs", "mean", "mean error", "Mean magnitude of the tracking error.", Position, Number(|j| Some(j.tracking_error.mean_abs))),
    Row::new("p95", "p95", "95 % error", "95 % of the time the error is below this.", Position, Number(|j| Some(j.tracking_error.p95)))
        .compared(Whole(|run| Some(run.tracking_error?.p95))),
    Row::new("peak", "peak", "peak error", "Largest tracking error.", Position, Number(|j| Some(j.tracking_error.peak)))
        .compared(Most)
        .limited(Judged::new(
            Limit::new("peak", "max-peak-deg", Some("max-peak-mm"), "peak error", "Largest peak error of a joint over the run", Position),
            |_| true,
            |j| Some(j.tracking_error.peak_time_s),
        )),
    Row::new("peak_time_s", "at", "time of the peak", "Time of the largest error.", Instant, Number(|j| Some(j.tracking_error.peak_time_s))),
    Row::new("bias", "bias", "bias", "Mean error with its sign, planned minus measured.", Position, Number(|j| Some(j.tracking_error.bias))),
    Row::new("standstill_rms", "standstill rms", "rms error at standstill", "Root mean square error while the plan rests: the steady-state error.", Position, Number(|j| Some(j.standstill_error?.rms)))
        .compared(Rms(|j| j.standstill_error))
        .limited(Judged::new(
            Limit::new("standstill-rms", "max-standstill-rms-deg", Some("max-standstill-rms-mm"), "rms error at standstill", "Largest RMS error of a joint while its plan is at rest", Position),
            |j| j.standstill_error.is_some(),
            |j| Some(j.standstill_error?.peak_time_s),
        )),
    Row::new("path_rms", "", "path error", "Root mean square distance to the planned path, at any time within 2 s.", Position, Number(|j| Some(j.path_error?.rms)))
        .compared(Whole(|run| Some(run.path_error?.rms))),
    Row::new("lag_s", "lag", "lag", "Time by which the measured speed follows the planned one, with its 95 % interval.", Duration, Number(|j| j.lag_s))
        .within(|j| j.lag_interval_s)
        .compared(Mean)
        .limited(Judged::new(
            Limit::new("lag", "max-lag-ms", None, "lag", "Largest velocity lag of a joint", Duration).or("no lag in the range looked at"),
            // A joint that is asked for a motion and shows no lag within the range looked at is later; of a slower plan no
            // joint shows one.
            |j| j.starts + j.edge_starts > 0,
            |_| None,
        )),
    Row::new("lag_correlation", "correlation", "correlation at the lag", "Correlation of planned and measured speed at that lag.", Correlation, Number(|j| j.lag_correlation)),
    Row::new("lag_share", "due to lag", "share of the lag", "Share of the squared error that is gone when the plan is shifted by the lag.", Share, Number(|j| Some(j.lag_share?.share))),
    Row::new("peak_speed", "", "peak speed", "Largest measured speed.", Speed, Number(|j| j.peak_speed)).compared(Most),
    Row::new("peak_acceleration", "", "peak acceleration", "Largest measured acceleration.", Acceleration, Number(|j| j.peak_acceleration)).compared(Most),
    Row::new("starts_from_rest", "starts", "starts", "Planned starts from rest.", Count, Number(|j| Some((j.starts - j.reversals) as f64))),
    Row::new("reversals", "reversals", "reversals", "Planned starts out of the opposite motion.", Count, Number(|j| Some(j.reversals as f64))),
    Row::new("unanswered_starts", "unanswered", "unanswered starts", "Planned starts that the joint does not answer.", Count, Number(|j| Some(j.unanswered_starts as f64))),
    Row::new("undated_starts", "undated", "undated starts", "Planned starts that the joint may have answered, at an instant that cannot be told.", Count, Number(|j| Some(j.undated_starts as f64))),
    Row::new("unplanned_starts", "unplanned", "unplanned starts", "Measured starts without a planned start.", Count, Number(|j| Some(j.unplanned_starts as f64))),
];
