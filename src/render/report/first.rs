//! The first screen: the run as a lane a joint, the worst start large.

use std::fmt::Write as _;

use maud::{Markup, html};

use crate::{
    render::{
        kit::{
            clean, ms,
            page::{
                Shows,
                chart::{Chart, Size},
                envelope::{crests, envelope},
            },
        },
        metric::position,
    },
    replay::{JointReplay, Transition, lane},
    series::Pair,
    workflow::report::Report,
};

use super::{
    crowd::{CROWD, HEIGHT, WIDTH, class, crowd},
    signals::{View, speed},
    tiles::tile,
};

/// Places of an error at most, nearly.
const PLACES: usize = 260;
/// Shown of the worst start before it, and after it at least and at most, s.
const BEFORE_S: f64 = 0.2;
const AFTER_S: [f64; 2] = [1.0, 4.0];

/// A lane for each joint, the worst first.
pub(super) fn lanes(report: &Report) -> Markup {
    let ends = report.pairs.iter().flat_map(|pair| [pair.t_s.first(), pair.t_s.last()]).flatten().copied();
    let [from_s, to_s] = crate::math::range(ends);
    if from_s >= to_s {
        return html! {};
    }
    let own = |name: &str| report.pairs.iter().find(|pair| pair.name == name);
    let worst_first = report.replay.joints_worst_first();
    let joints = worst_first.into_iter().filter_map(|joint| Some((joint, own(&joint.name)?)));
    html! {
        p class="hint" {
            "Waits: the plan has left rest, the joint has not. Follows: the plan moves, and the joint. Settles: the plan rests, the joint moves on. \
             Grey: both rest. Blank: nothing was measured, or there is no plan. A line that stays up while both rest is an error that stays. \
             In lanes of long runs the height of a colour is its share of the time."
        }
        table class="lanes" {
            thead { tr {
                th { "Joint" }
                th class="legend" {
                    span { i class="waits" {} "waits" }
                    span { i class="follows" {} "follows" }
                    span { i class="settles" {} "settles" }
                    span { i class="error" {} "error, each joint by its own largest" }
                }
                th class="number" { "largest error" }
                th class="number" { "latest start" }
            } }
            tbody {
                @for (joint, pair) in joints {
                    tr {
                        th title=(clean(&joint.name)) { (clean(&joint.name)) }
                        td class="lane" { (drawn(report, joint, pair, [from_s, to_s])) }
                        td class="number" { (position(joint.kind, joint.tracking_error.peak)) }
                        td class="number" { (latest(report, &joint.name)) }
                    }
                }
            }
            tfoot { tr {
                td {}
                td class="ends" { span { (format!("{from_s:.1} s")) } span { (format!("{to_s:.1} s")) } }
                td {} td {}
            } }
        }
    }
}

/// The delay of the joint's latest start, or that it left one out.
fn latest(report: &Report, joint: &str) -> String {
    let of = report.replay.joints.iter().find(|found| found.name == joint);
    if let Some(never) = of.map(|found| found.unanswered_starts).filter(|n| *n > 0) {
        return format!("{never} never");
    }
    report.replay.longest_delay_s(joint).map_or(String::new(), |s| format!("{} ms", ms(s)))
}

/// Stretches, and over them the error's magnitude.
fn drawn(report: &Report, joint: &JointReplay, pair: &Pair, [from_s, to_s]: [f64; 2]) -> Markup {
    let seen_s: Vec<[f64; 2]> = pair.spans_s().collect();
    let stretches = lane(&report.replay, &joint.name, &seen_s);
    let place = |s: f64| ((s - from_s) / (to_s - from_s) * WIDTH).clamp(0.0, WIDTH);
    let fixed = |value: f64| format!("{value:.1}");
    html! {
        svg viewBox="0 0 1000 30" preserveAspectRatio="none" aria-hidden="true" {
            @for gap in seen_s.windows(2).map(|two| [two[0][1], two[1][0]]) {
                rect class="gap" x=(fixed(place(gap[0]))) y="0" height="30" width=(fixed((place(gap[1]) - place(gap[0])).max(1.0))) {
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
                    title { (class(one.phase)) (format!(" {:.2} to {:.2} s", one.from_s, one.to_s)) }
                }
            }
            path class="error" d=(outline(pair, joint.tracking_error.peak, stretches.len() > CROWD, place)) {}
        }
    }
}

/// The error's magnitude as a line over the lane; gaps lift the pen.
fn outline(pair: &Pair, most: f64, crowded: bool, place: impl Fn(f64) -> f64) -> String {
    let error: Vec<f64> = pair.planned.iter().zip(&pair.measured).map(|(p, m)| (p - m).abs()).collect();
    let (mut path, mut pen) = (String::new(), 'M');
    // Of more swings than places only the peaks are left: the way down between them would fill the lane.
    let places = if crowded {
        crests(&pair.segments, &error, PLACES)
    } else {
        envelope(&pair.segments, &[&error], PLACES)
    };
    for at in places {
        let Some((t_s, error)) = at.and_then(|i| Some((pair.t_s.get(i)?, error.get(i)?))) else {
            pen = 'M';
            continue;
        };
        let share = if most > 0.0 { error / most } else { 0.0 };
        let y = 0.97 * HEIGHT * (1.0 - share) + 0.5;
        let _ = write!(path, "{pen}{:.1} {y:.1}", place(*t_s));
        pen = 'L';
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
