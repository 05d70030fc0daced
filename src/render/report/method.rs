//! How the numbers of a report were made: thresholds, windows, counts, resolution.

use crate::{
    math,
    render::{
        kit::{Block, Id, Section, fact, ms},
        metric::{number, on_paper, position, unit},
        source::{why, why_clock},
    },
    replay::{Dimension, JointReplay},
    series::JointKind,
    workflow::report::Report,
};

/// Least and greatest of a number of the joints of a kind.
fn range(
    report: &Report,
    kind: JointKind,
    of: &dyn Fn(&JointReplay) -> f64,
    show: &dyn Fn(f64) -> String,
) -> String {
    let joints = report.replay.joints.iter().filter(|joint| joint.kind == kind);
    let [least, most] = math::range(joints.map(of)).map(show);
    if least == most { least } else { format!("{least} to {most}") }
}

fn kinds(report: &Report) -> Vec<JointKind> {
    let has = |kind: &JointKind| report.replay.joints.iter().any(|joint| joint.kind == *kind);
    [JointKind::Turns, JointKind::Slides].into_iter().filter(has).collect()
}

/// What holds for joints that turn, and for those that slide, where there are both.
fn by_kind(report: &Report, words: &dyn Fn(JointKind) -> String) -> String {
    if let [one] = kinds(report).as_slice() {
        return words(*one);
    }
    let named = [(JointKind::Turns, "joints that turn"), (JointKind::Slides, "Joints that slide")];
    named.map(|(kind, name)| format!("{name}: {}", words(kind))).join(". ")
}

fn start(report: &Report, kind: JointKind) -> String {
    let rules = &report.replay.rules;
    let sizes = rules.sizes(kind);
    let speed = unit(Dimension::Speed, kind);
    let deg_or_mm = |value: f64| number(Dimension::Position, kind, value);
    format!(
        "a plan starts above {} {speed} and rests below {}; a joint starts above {} {speed} and rests below {}, by its noise; \
         it travels at least {}; a set value that steps by {} starts with the step",
        deg_or_mm(sizes.start_speed),
        deg_or_mm(sizes.stop_speed),
        range(report, kind, &|joint| joint.thresholds.measured_start, &deg_or_mm),
        range(report, kind, &|joint| joint.thresholds.measured_stop, &deg_or_mm),
        position(kind, sizes.min_travel),
        position(kind, rules.step_travels * sizes.min_travel),
    )
}

fn speed(report: &Report, kind: JointKind) -> String {
    format!(
        "slope of a local quadratic over +-{} ms; noise {} {}, time resolution {} ms",
        range(report, kind, &|joint| joint.thresholds.window_s, &ms),
        range(report, kind, &|joint| joint.noise.sigma, &|noise| format!("{:.4}", on_paper(kind, noise))),
        unit(Dimension::Position, kind),
        range(report, kind, &|joint| joint.sample_interval_s, &ms),
    )
}

pub(super) fn method(report: &Report) -> Option<Section> {
    let rules = &report.replay.rules;
    if report.replay.joints.is_empty() {
        return None;
    }
    let settled: Vec<String> =
        kinds(report).iter().map(|kind| position(*kind, rules.sizes(*kind).settle_band)).collect();
    let settled = settled.join(" or ");
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
        fact("start", by_kind(report, &|kind| start(report, kind))),
        fact(
            "delay",
            format!(
                "time between plan and joint passing the same speed. never: the joint has no start, and within the window it covers less than \
                 {:.0} % of the planned travel. creeps: it covers more, but moved before or crept into the motion, so its start \
                 has no time. unclear: the planned motion is too small for the noise, or the next start comes within {:.0} s, or the samples are too far apart to tell. Only \
                 never counts as unanswered; creeps and unclear count as undated",
                100.0 * rules.follow_share,
                rules.match_after_s,
            ),
        ),
        fact("speed", by_kind(report, &|kind| speed(report, kind))),
        fact(
            "window",
            format!(
                "peak, rms and area are taken from the planned start to the next one, at most {:.0} s; an error is settled within \
                 {} for {} ms",
                rules.transition_window_s,
                settled,
                ms(rules.settle_hold_s)
            ),
        ),
        fact(
            "lag",
            format!(
                "time shift within +-{} ms at which measured and planned speed correlate best, while the plan moves",
                ms(rules.lag_max_s)
            ),
        ),
        fact(
            "due to lag",
            format!(
                "share of the squared error that is gone when the plan is shifted by that lag, rests included; its interval is over \
                 planned motions, of which those within {:.0} s of each other count as one event. From {:.0} % on, which halves \
                 the rms error, the error is mostly lag",
                rules.same_event_s,
                100.0 * rules.mostly_lag_share,
            ),
        ),
        fact("source", why(&report.source)),
    ];
    let clock = why_clock(&report.source).map(|why| fact("clock", why));
    let facts = facts.into_iter().chain(clock).collect();
    Some(Section::new(Id::METHOD, "How", [Block::Facts(facts)]))
}
