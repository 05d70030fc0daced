//! Each joint of the next run: plan, command and expected answer between its limits.

use crate::{
    render::{
        kit::page::{
            chart::{Chart, Panel, Role, Series, Size, at, rounded, span, times},
            envelope::envelope,
        },
        metric::{on_paper, position, unit},
    },
    replay::Dimension,
    series::JointKind,
    workflow::replan::JointCourse,
};

/// Places of a line at most, nearly.
const MOST: usize = 1500;

/// A limit is drawn if it is no farther from the lines than they span.
const NEAR: f64 = 1.0;

/// Lines of one panel, rad or rad/s, over the same places.
struct Lines<'a> {
    course: &'a JointCourse,
    places: Vec<Option<usize>>,
}

/// Angle, distance from the plan and speed over time.
pub(super) fn chart(course: &JointCourse) -> Chart {
    let off = |angle_rad: &[f64]| -> Vec<f64> {
        angle_rad.iter().zip(&course.planned.angle_rad).map(|(angle, planned)| angle - planned).collect()
    };
    let moved = off(&course.sent.angle_rad);
    let answer = course.response.as_ref();
    let missed = answer.map(|(drawn, _)| off(&drawn.angle_rad));
    let mut looked_at: Vec<&[f64]> = vec![&course.planned.angle_rad, &moved, &course.sent.speed_rad_s];
    looked_at.extend(missed.iter().map(Vec::as_slice));
    let whole = 0..course.t_s.len();
    let lines = Lines { course, places: envelope(std::slice::from_ref(&whole), &looked_at, MOST) };
    let three = |planned: &[f64], sent: &[f64], answer: Option<&[f64]>| {
        let mut all =
            vec![lines.line("plan", Role::Planned, planned), lines.line("command", Role::Error, sent)];
        all.extend(answer.map(|values| lines.line("expected", Role::Measured, values)));
        all
    };
    let answered =
        |of: fn(&crate::workflow::replan::Drawn) -> &Vec<f64>| answer.map(|(drawn, _)| of(drawn).as_slice());
    let mut angle =
        three(&course.planned.angle_rad, &course.sent.angle_rad, answered(|drawn| &drawn.angle_rad));
    let mut speed =
        three(&course.planned.speed_rad_s, &course.sent.speed_rad_s, answered(|drawn| &drawn.speed_rad_s));
    limit(&mut angle, course.kind, &course.range_rad);
    limit(&mut speed, course.kind, &course.speed_limit_rad_s);
    let mut apart = lines.band(missed.as_deref());
    apart.push(lines.line("command", Role::Error, &moved));
    apart.extend(missed.as_deref().map(|missed| lines.line("expected", Role::Measured, missed)));
    let panel = |label: &str, dimension, share, series| {
        Panel::of(format!("{label} ({})", unit(dimension, course.kind)), share, series)
    };
    let ends = course.t_s.first().zip(course.t_s.last());
    Chart {
        title: course.name.clone(),
        note: note(course, &moved),
        x_label: "Time (s)".into(),
        xs: vec![
            times(&course.t_s, &lines.places),
            ends.map_or_else(Vec::new, |(from, to)| vec![rounded(*from), rounded(*to)]),
        ],
        panels: vec![
            panel(
                if course.kind == JointKind::Turns { "Angle" } else { "Length" },
                Dimension::Position,
                0.34,
                angle,
            ),
            panel("Off plan", Dimension::Position, 0.33, apart),
            panel("Speed", Dimension::Speed, 0.33, speed),
        ],
        group: Some("run"),
        height: 380,
        size: Size::Half,
        ..Chart::default()
    }
}

/// The numbers that the lines are held to.
fn note(course: &JointCourse, moved_rad: &[f64]) -> String {
    let most_rad = moved_rad.iter().fold(0.0_f64, |most, moved| most.max(moved.abs()));
    let kind = course.kind;
    let [low, high] = course.range_rad.map(|rad| format!("{:.0}", on_paper(kind, rad)));
    let range = course.range_rad.iter().all(|rad| rad.is_finite());
    let range = range.then(|| format!("{low} to {high} {}", unit(Dimension::Position, kind)));
    let most = course.speed_limit_rad_s;
    let speed = most.iter().all(|limit| limit.is_finite()).then(|| {
        let [down, up] = most.map(|limit| format!("{:.1}", on_paper(kind, limit)));
        let most = if down.strip_prefix('-') == Some(&*up) { up } else { format!("{down} to {up}") };
        format!("{most} {}", unit(Dimension::Speed, kind))
    });
    let limits: Vec<String> = range.into_iter().chain(speed).collect();
    let limits = if limits.is_empty() { String::new() } else { format!("; limits {}", limits.join(", ")) };
    format!("corrected by up to {}{limits}", position(kind, most_rad))
}

impl Lines<'_> {
    fn line(&self, name: &str, role: Role, values: &[f64]) -> Series {
        let y = at(values, &self.places).map(|value| rounded(on_paper(self.course.kind, value))).collect();
        Series::of(name, role, 0, y)
    }

    /// Both edges of what 90 % of starts stay within.
    fn band(&self, missed_rad: Option<&[f64]>) -> Vec<Series> {
        let band_rad = self.course.response.as_ref().map_or(0.0, |(_, band_rad)| *band_rad);
        let edge = |(name, side): (&str, f64)| {
            let values: Vec<f64> =
                missed_rad.iter().copied().flatten().map(|rad| rad + side * band_rad).collect();
            self.line(name, Role::Band, &values)
        };
        let edges = [("90 % of starts", -1.0), ("", 1.0)];
        missed_rad.map_or_else(Vec::new, |_| edges.into_iter().map(edge).collect())
    }
}

/// Limits that are near enough to be seen beside the lines.
fn limit(lines: &mut Vec<Series>, kind: JointKind, limits: &[f64; 2]) {
    let [low, high] = span(lines.iter().flat_map(|line| &line.y).copied());
    let room = NEAR * (high - low);
    for limit in limits.map(|limit| on_paper(kind, limit)) {
        if limit > low - room && limit < high + room {
            lines.push(Series::of("limit", Role::Guide, 1, vec![rounded(limit); 2]));
        }
    }
}
