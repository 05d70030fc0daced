//! How the numbers of a report were made: thresholds, windows, counts, resolution.

use crate::{
    render::kit::{Block, Id, Section, deg, fact, ms},
    workflow::report::Report,
};

pub(super) fn method(report: &Report) -> Option<Section> {
    let rules = &report.replay.rules;
    let joints = &report.replay.joints;
    let range = |of: &dyn Fn(usize) -> f64, show: fn(f64) -> String| {
        let values: Vec<f64> = (0..joints.len()).map(of).collect();
        let least = values.iter().copied().fold(f64::INFINITY, f64::min);
        let most = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let (least, most) = (show(least), show(most));
        if least == most { least } else { format!("{least} to {most}") }
    };
    if joints.is_empty() {
        return None;
    }
    let unmatched: usize = report.alignment.iter().map(|a| a.unmatched).sum();
    let matched: usize = report.alignment.iter().map(|a| a.matched).sum();
    let segments = report.alignment.iter().map(|a| a.segments).max().unwrap_or(0);
    let facts = vec![
        fact("error", "planned minus measured at the same instant; rms and mean weighted by time"),
        fact(
            "matching",
            format!(
                "plan interpolated at measured stamps: {matched} samples matched, {unmatched} without a plan; {}",
                if segments == 1 {
                    "no gaps".to_owned()
                } else {
                    format!("{segments} stretches between gaps")
                }
            ),
        ),
        fact(
            "start",
            format!(
                "speed above {} deg/s (plan), {} deg/s (measured, from its noise), rest below {} and {}; travel of at least {} deg",
                deg(rules.start_floor_rad_s),
                range(&|j| joints[j].thresholds.measured_start_rad_s, deg),
                deg(rules.stop_floor_rad_s),
                range(&|j| joints[j].thresholds.measured_stop_rad_s, deg),
                deg(rules.min_travel_rad),
            ),
        ),
        fact(
            "late",
            format!(
                "when plan and joint pass the same speed; never: within the window the joint covers less than {:.0} % of the \
                 planned travel; creeps: it covers more, but was under way or crept into the motion, so it leaves rest at no \
                 instant; unclear: planned too small for its noise, or the next start comes within {:.0} s. Only never is no \
                 answer",
                100.0 * rules.follow_share,
                rules.match_after_s,
            ),
        ),
        fact(
            "speed",
            format!(
                "local quadratic over +-{} ms; noise {} deg, time resolution {} ms",
                range(&|j| joints[j].thresholds.window_s, ms),
                range(&|j| joints[j].noise.sigma, |rad| format!(
                    "{:.4}",
                    crate::units::degrees_from_radians(rad)
                )),
                range(&|j| joints[j].sample_interval_s, ms),
            ),
        ),
        fact(
            "window",
            format!(
                "peak, rms, area from the planned start up to the next one, {:.0} s at most; settled within {} deg for {} ms",
                rules.transition_window_s,
                deg(rules.settle_band_rad),
                ms(rules.settle_hold_s)
            ),
        ),
        fact(
            "lag",
            format!(
                "shift of best correlation of the speeds within +-{} ms, over moving stretches",
                ms(rules.lag_max_s)
            ),
        ),
        fact(
            "by lag",
            format!(
                "share of the squared error that is gone when the plan is shifted by that lag, rests included; interval over \
                 planned motions, those within {:.0} s of each other as one event; from {:.0} % on, which halves the rms, \
                 the error is mostly lag",
                rules.same_event_s,
                100.0 * rules.mostly_lag_share,
            ),
        ),
        fact("source", report.source.why.clone()),
        fact("clock", report.source.time_base_why.clone()),
    ];
    Some(Section::new(Id::METHOD, "How", [Block::Facts(facts)]))
}
