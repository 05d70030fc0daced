//! The first screen: the run as a lane a joint, the worst start large.

use std::fmt::Write as _;

use maud::{Markup, html};

use crate::{
    math::whole,
    render::{
        kit::{
            clean, counted, ms,
            page::{
                Shows,
                chart::{Chart, Size},
            },
        },
        metric::position,
    },
    replay::{JointReplay, Replay, Transition, lane},
    series::Pair,
    workflow::report::Report,
};

use super::{
    crowd::{CROWD, HEIGHT, WIDTH, class, crowd, waits, word},
    signals::{View, speed},
    tiles::tile,
};

/// More joints than this fill the screen; so many are shown then.
const MANY: usize = 12;
const FIRST: usize = 8;
/// More samples of an error than this are drawn by columns.
const PLACES: usize = 1000;
/// Of the largest error of all joints of a unit, this fills a lane at least.
const LEAST_SHARE: f64 = 0.25;
/// Shown of the worst start before it, and after it at least and at most, s.
const BEFORE_S: f64 = 0.2;
const AFTER_S: [f64; 2] = [1.0, 4.0];

/// A lane for each joint, the worst first; of many joints those that matter least are folded.
pub(super) fn lanes(report: &Report) -> Markup {
    let ends = report.pairs.iter().flat_map(|pair| [pair.t_s.first(), pair.t_s.last()]).flatten().copied();
    let span_s = crate::math::range(ends);
    let [from_s, to_s] = span_s;
    if from_s >= to_s {
        return html! {};
    }
    let joints = report.replay.joints_worst_first();
    let shown = if joints.len() > MANY { FIRST } else { joints.len() };
    let (first, rest) = joints.split_at(shown);
    let rows = |joints: &[&JointReplay]| rows(report, joints, span_s);
    html! {
        p class="hint" {
            "Waits: the plan has left rest, the joint has not; the strip below a lane shows each, however short. Follows: the plan moves, and \
             the joint. Settles: the plan rests, the joint moves on. Grey: both rest. Blank: nothing was measured, or there is no plan. A line that \
             stays up while both rest is an error that stays. Lines of small errors are drawn small: a quarter of the largest error of all \
             joints fills a lane at least. In lanes of long runs the height of a colour is its share of the time."
        }
        table class="lanes" {
            thead { tr {
                th { "Joint" }
                th class="legend" {
                    span { i class="waits" {} "waits" }
                    @if joints.iter().any(|joint| joint.unanswered_starts > 0) { span { i class="never" {} "never answered" } }
                    span { i class="follows" {} "follows" }
                    span { i class="settles" {} "settles" }
                    span { i class="error" {} "error" }
                }
                th class="number" { "largest error" }
                th class="number" { "latest start" }
            } }
            tbody { (rows(first)) }
            tfoot { tr {
                td {}
                td class="ends" { span { (format!("{from_s:.1} s")) } span { (format!("{to_s:.1} s")) } }
                td {} td {}
            } }
        }
        @if !rest.is_empty() {
            details {
                summary { (counted(rest.len(), "more joint")) ", with smaller errors" }
                table class="lanes" { tbody { (rows(rest)) } }
            }
        }
    }
}

fn rows(report: &Report, joints: &[&JointReplay], span_s: [f64; 2]) -> Markup {
    let own = |joint: &JointReplay| report.pairs.iter().find(|pair| pair.name == joint.name);
    html! {
        @for (joint, pair) in joints.iter().filter_map(|joint| Some((joint, own(joint)?))) {
            tr {
                th title=(clean(&joint.name)) {
                    (clean(&joint.name))
                    span class="under" { (position(joint.kind, joint.tracking_error.peak)) }
                    span class={ "under" @if joint.unanswered_starts > 0 { " bad" } } { (latest(report, joint)) }
                }
                td class="lane" { (drawn(report, joint, pair, span_s)) }
                td class="number" { (position(joint.kind, joint.tracking_error.peak)) }
                td class={ "number" @if joint.unanswered_starts > 0 { " bad" } } { (latest(report, joint)) }
            }
        }
    }
}

/// The delay of the joint's latest start, or that it left one out.
fn latest(report: &Report, joint: &JointReplay) -> String {
    match (joint.unanswered_starts, joint.starts, report.replay.longest_delay_s(&joint.name)) {
        (0, 0, _) => "no start".to_owned(),
        (0, _, None) => "not timed".to_owned(),
        (0, _, Some(s)) => format!("{} ms", ms(s)),
        (never, ..) => format!("{never} never"),
    }
}

/// The error that fills a lane: no noise of a joint that errs little is to look like the largest error of all.
fn fills(replay: &Replay, joint: &JointReplay) -> f64 {
    let own = replay.joints.iter().filter(|other| other.kind == joint.kind);
    let largest = own.map(|other| other.tracking_error.peak).fold(0.0, f64::max);
    joint.tracking_error.peak.max(LEAST_SHARE * largest).max(replay.rules.sizes(joint.kind).settle_band)
}

/// Stretches, and over them the error's magnitude.
fn drawn(report: &Report, joint: &JointReplay, pair: &Pair, [from_s, to_s]: [f64; 2]) -> Markup {
    let seen_s: Vec<[f64; 2]> = pair.spans_s().collect();
    let stretches = lane(&report.replay, &joint.name, &seen_s);
    let place = |s: f64| ((s - from_s) / (to_s - from_s) * WIDTH).clamp(0.0, WIDTH);
    let fixed = |value: f64| format!("{value:.1}");
    html! {
        svg viewBox="0 0 1000 36" preserveAspectRatio="none" aria-hidden="true" {
            @for gap in seen_s.windows(2).map(|two| [two[0][1], two[1][0]]) {
                rect class="gap" x=(fixed(place(gap[0]))) y="0" height="36" width=(fixed((place(gap[1]) - place(gap[0])).max(1.0))) {
                    title { (format!("not measured {:.2} to {:.2} s", gap[0], gap[1])) }
                }
            }
            @if stretches.len() > CROWD {
                (crowd(&stretches, &pair.name, [from_s, to_s]))
            }
            @for one in stretches.iter().filter(|_| stretches.len() <= CROWD) {
                @let shows = Shows::around(&pair.name, [one.from_s, one.to_s]);
                rect class=(class(one.phase)) x=(fixed(place(one.from_s))) y="0" height="30"
                    width=(fixed((place(one.to_s) - place(one.from_s)).max(1.0)))
                    data-from=(shows.from) data-to=(shows.to) data-joint=(shows.joint) {
                    title { (word(one.phase)) (format!(" {:.2} to {:.2} s", one.from_s, one.to_s)) }
                }
            }
            (waits(&stretches, [from_s, to_s]))
            path class="error" d=(outline(pair, fills(&report.replay, joint), place)) {}
        }
    }
}

/// The error's magnitude as a line over the lane, or, of more samples than can be seen, the largest of each column: a column without an
/// error is at zero. Gaps lift the pen.
fn outline(pair: &Pair, most: f64, place: impl Fn(f64) -> f64) -> String {
    let all = pair.planned.iter().zip(&pair.measured).zip(pair.t_s.iter());
    let all: Vec<(f64, f64)> = all.map(|((p, m), t_s)| (place(*t_s), (p - m).abs())).collect();
    let y = |error: f64| {
        let share = if most > 0.0 { error / most } else { 0.0 };
        format!("{:.1}", 0.97 * HEIGHT * (1.0 - share) + 0.5)
    };
    let mut path = String::new();
    for segment in pair.segments.iter().filter_map(|segment| all.get(segment.clone())) {
        if all.len() <= PLACES {
            for (k, (x, error)) in segment.iter().enumerate() {
                let _ = write!(path, "{}{x:.1} {}", if k == 0 { 'M' } else { 'L' }, y(*error));
            }
            continue;
        }
        let mut drawn = String::new();
        for column in segment.chunk_by(|a, b| whole(a.0) == whole(b.0)) {
            let high = y(column.iter().map(|at| at.1).fold(0.0, f64::max));
            if drawn.is_empty() {
                let _ = write!(path, "M{:.0} {high}", column[0].0.floor());
            } else if high != drawn {
                let _ = write!(path, "H{:.0}V{high}", column[0].0.floor());
            }
            drawn = high;
        }
        let _ = segment.last().map(|last| write!(path, "H{:.0}", last.0.floor() + 1.0));
    }
    path
}

/// The worst start from its planned instant: position from there, speed, how far behind.
pub(super) fn worst_start(report: &Report) -> Option<Chart> {
    let worst: &Transition = report.worst()?;
    let pair = report.pairs.iter().find(|pair| pair.name == worst.joint)?;
    let latest_s = worst.onset_delay_s.unwrap_or(0.0).max(worst.time_to_peak_s);
    let after_s = (latest_s + 0.4).clamp(AFTER_S[0], AFTER_S[1]);
    let mut chart = tile(worst, pair, [BEFORE_S, after_s]);
    let (zero_s, sign) = (worst.planned_onset_s, f64::from(worst.direction));
    let seen = View { zero_s, shown_s: [-BEFORE_S, after_s], sign };
    let speed = speed(&mut chart, report, pair, seen, 0.4)?;
    chart.panels.insert(1, speed);
    let of = if report.fault.is_some() { " of the others" } else { "" };
    chart.title = format!("The worst start{of}: {}", chart.title);
    (chart.size, chart.height, chart.x_range) = (Size::Half, 330, Some([-BEFORE_S, after_s]));
    Some(chart)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::series::{Track, align};

    fn pair(n: u32, error: impl Fn(u32) -> f64) -> Pair {
        let t_s: Vec<f64> = (0..n).map(|k| 0.01 * f64::from(k)).collect();
        let track = |values: Vec<f64>| Track::new("boom", t_s.clone(), values, &[]).unwrap();
        align(&track(vec![0.0; t_s.len()]), &track((0..n).map(error).collect())).unwrap()
    }

    #[test]
    fn a_column_of_a_long_run_without_an_error_is_at_zero() {
        let n = 200_000;
        let long = pair(n, |k| if (50_000..50_100).contains(&k) { 1.0 } else { 0.0 });
        let drawn = outline(&long, 1.0, |s| s / (0.01 * f64::from(n)) * WIDTH);
        assert_eq!(drawn, "M0 29.6H250V0.5H251V29.6H1000");
        let short = pair(3, |k| if k == 1 { 2.0 } else { 0.0 });
        assert_eq!(outline(&short, 2.0, |s| 1e3 * s), "M0.0 29.6L10.0 0.5L20.0 29.6");
    }
}
