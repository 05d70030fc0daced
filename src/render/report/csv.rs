//! Transitions as comma-separated values, SI units.

use std::fmt::Write as _;

use crate::{
    render::{
        kit,
        transition::{answer_word as answer, kind},
    },
    workflow::report::Report,
};

const HEAD: [&str; 23] = [
    "joint",
    "kind",
    "direction",
    "planned_onset_s",
    "measured_onset_s",
    "onset_delay_s",
    "onset_delay_low_s",
    "onset_delay_high_s",
    "displacement_delay_s",
    "breakaway_error_rad",
    "jump_rad_s",
    "peak_error_rad",
    "peak_error_signed_rad",
    "time_to_peak_s",
    "error_area_rad_s",
    "rms_error_rad",
    "overshoot_rad",
    "settling_time_s",
    "window_start_s",
    "window_end_s",
    "samples",
    "time_resolution_s",
    "answer",
];

/// One row a transition, in order of joint and time; remarks follow as lines that start with `#`.
pub fn csv(report: &Report) -> String {
    let number = |value: Option<f64>| value.map_or(String::new(), |v| format!("{v}"));
    let rows = report.replay.transitions.iter().map(|t| {
        let [low, high] = t.onset_delay_interval_s.map_or([None, None], |[a, b]| [Some(a), Some(b)]);
        vec![
            t.joint.clone(),
            kind(t.kind).to_owned(),
            t.direction.to_string(),
            number(Some(t.planned_onset_s)),
            number(t.measured_onset_s),
            number(t.onset_delay_s),
            number(low),
            number(high),
            number(t.displacement_delay_s),
            number(t.breakaway_error_rad),
            number(t.jump_rad_s),
            number(Some(t.peak_error_rad)),
            number(Some(t.peak_error_signed_rad)),
            number(Some(t.time_to_peak_s)),
            number(Some(t.error_area_rad_s)),
            number(Some(t.rms_error_rad)),
            number(Some(t.overshoot_rad)),
            number(t.settling_time_s),
            number(Some(t.window_s[0])),
            number(Some(t.window_s[1])),
            t.samples.to_string(),
            number(Some(t.time_resolution_s)),
            answer(t.answer).to_owned(),
        ]
    });
    let mut text = kit::csv(HEAD, rows);
    for remark in report.remarks.as_slice() {
        let message = remark.message.replace(['\n', '\r'], " ");
        let _ = writeln!(text, "# {} x{}: {message}", remark.code.name(), remark.count);
    }
    text
}
