//! The metrics of a transition, in the order of the CSV.

use super::{
    Dimension::{Area, Count, Duration, Instant, Position, Sign, Speed, Word},
    Judged, Limit, Metric,
    Read::{Interval, Number, Word as Text},
    Together::Nothing,
};
use crate::replay::{Answer, Kind, OnsetMethod, Transition};

/// Key of the metric that transitions are ranked and judged by.
pub const PEAK_ERROR: &str = "peak_error";

/// Key of the limit on start delays: starts without a time are not judged by it.
pub const ONSET_DELAY_LIMIT: &str = "onset-delay";

/// Key of the measured minus the planned onset.
pub const ONSET_DELAY: &str = "onset_delay_s";

type Row = Metric<Transition>;

#[rustfmt::skip]
/// One row a metric.
pub static TRANSITION: &[Row] = &[
    Row::new("joint", "joint", "joint", "Name of the joint.", Word, Text(|t| t.joint.clone())),
    Row::new("unit", "", "unit", "Unit of the joint's position.", Word, Text(|t| t.joint_kind.unit().to_owned())),
    Row::new("index", "", "index", "Place among the planned starts of the joint, from 1.", Count, Number(|t| Some(t.index as f64))),
    Row::new("id", "", "id", "Joint and planned onset.", Word, Text(|t| t.id.clone())),
    Row::new("kind", "kind", "kind", "From rest (start) or out of the opposite motion (reversal).", Word, Text(|t| t.kind.name().to_owned())),
    Row::new("direction", "dir", "direction", "Sign of the planned motion.", Sign, Number(|t| Some(f64::from(t.direction)))),
    Row::new("planned_onset_s", "at", "planned onset", "Time at which the plan starts.", Instant, Number(|t| Some(t.planned_onset_s))),
    Row::new("measured_onset_s", "", "measured onset", "Time at which the joint starts.", Instant, Number(|t| t.measured_onset_s)),
    Row::new("displacement_delay_s", "", "displacement delay", "Time by which the joint has travelled a small distance later than its plan.", Duration, Number(|t| t.displacement_delay_s)),
    Row::new(PEAK_ERROR, "peak", "peak error", "Largest tracking error in the window.", Position, Number(|t| Some(t.peak_error)))
        .compared(Nothing)
        .limited(Judged::new(
            Limit::new("transition-peak", "max-transition-peak-deg", Some("max-transition-peak-mm"), "transition peak", "Largest peak error in a transition", Position),
            |_| true,
            |t| Some(t.planned_onset_s + t.time_to_peak_s),
        )),
    Row::new("peak_error_signed", "", "signed peak error", "The same with its sign, planned minus measured.", Position, Number(|t| Some(t.peak_error_signed))),
    Row::new("time_to_peak_s", "peak after", "time to peak", "Time from the planned onset to the peak error.", Duration, Number(|t| Some(t.time_to_peak_s))),
    Row::new("error_area", "", "error area", "Integral of the error magnitude over the window.", Area, Number(|t| Some(t.error_area))),
    Row::new("rms_error", "rms", "rms error", "Root mean square tracking error in the window.", Position, Number(|t| Some(t.rms_error)))
        .compared(Nothing),
    Row::new(ONSET_DELAY, "delay", "start delay", "Measured minus planned onset.", Duration, Number(|t| t.onset_delay_s))
        .or(|t| t.answer.word())
        .compared(Nothing)
        .limited(Judged::new(
            Limit::new(ONSET_DELAY_LIMIT, "max-start-delay-ms", None, "start delay", "Largest delay of a start; a start that the machine does not answer exceeds it", Duration)
                .or("a start without an answer"),
            |t| matches!(t.answer, Answer::Timed | Answer::Never),
            |t| Some(t.planned_onset_s),
        )),
    Row::new("onset_delay_interval_s", "95 %", "interval of the start delay", "95 % confidence interval of the dead time.", Duration,
        Interval(["onset_delay_low_s", "onset_delay_high_s"], |t| t.onset_delay_interval_s)),
    Row::new("breakaway_error", "at onset", "error at the onset", "Tracking error when the joint starts, along the motion.", Position, Number(|t| t.breakaway_error)),
    Row::new("jump", "", "jump of speed", "Largest excess of measured over planned speed soon after the onset.", Speed, Number(|t| t.jump)),
    Row::new("overshoot", "overshoot", "overshoot", "Largest error of the opposite sign after the peak.", Position, Number(|t| (t.answer != Answer::Never).then_some(t.overshoot))),
    Row::new("settling_time_s", "settling", "settling time", "Time from the planned onset until the error stays in the settling band.", Duration, Number(|t| t.settling_time_s)),
    Row::new("window_s", "", "window", "From the planned onset to the next one, the end of the segment or the longest window.", Instant,
        Interval(["window_start_s", "window_end_s"], |t| Some(t.window_s))),
    Row::new("samples", "", "samples", "Samples in the window.", Count, Number(|t| Some(t.samples as f64))),
    Row::new("time_resolution_s", "", "time resolution", "Time between samples of the plan or of the measurement, whichever is longer.", Duration, Number(|t| Some(t.time_resolution_s))),
    Row::new("answer", "", "answer", "timed: answered at a known instant; creeps: follows without one; unclear: cannot be told; never: does not follow.", Word, Text(|t| t.answer.name().to_owned())),
    Row::new("onset_method", "", "method", "How the onsets were found.", Word, Text(|t| t.onset_method.name().to_owned())),
];

impl Kind {
    /// Its name, as in documents.
    pub fn name(self) -> &'static str {
        match self {
            Self::Start => "start",
            Self::Reversal => "reversal",
        }
    }
}

impl OnsetMethod {
    /// Its name, as in documents.
    pub fn name(self) -> &'static str {
        match self {
            Self::Fit => "fit",
            Self::Crossing => "crossing",
        }
    }
}

impl Answer {
    /// Its name, as in documents.
    pub fn name(self) -> &'static str {
        match self {
            Self::Timed => "timed",
            Self::Unclear => "unclear",
            Self::Creeps => "creeps",
            Self::Never => "never",
        }
    }

    /// In place of a delay; means over runs lack one that single runs have.
    pub fn word(self) -> &'static str {
        if self == Self::Timed { "-" } else { self.name() }
    }
}
