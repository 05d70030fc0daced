//! The motion of a plan: position and speed of each joint with key points and limits, and the way of the tool.

use crate::{
    plan::{Limit, SampledMotion},
    render::{
        kit::page::{
            chart::{Chart, Panel, Role, Series, Size, hundredths, millimetres, span},
            scene::{Scene, broadest_rad},
        },
        metric::on_paper,
    },
    series::JointKind,
    workflow::plan::Course,
};

/// Limits further from the motion than this many times what it spans are not drawn: they would flatten it.
const NEAR: f64 = 0.6;

/// Beside a motion, as a share of its duration: the last key point and its number.
const ROOM: f64 = 0.03;

pub(super) fn motion_charts(joints: &[String], course: &Course) -> Vec<(String, Chart)> {
    let chart = |(k, joint): (usize, &String)| (joint.clone(), joint_chart(joint, k, course));
    joints.iter().enumerate().map(chart).collect()
}

fn joint_chart(joint: &str, k: usize, course: &Course) -> Chart {
    let motion = &course.motion;
    let ends = [0.0, motion.t_s.last().copied().unwrap_or_default()];
    let kind = motion.kinds.get(k).copied().unwrap_or_default();
    let points: Vec<f64> = motion.key_points_rad[k].iter().map(|q| hundredths(on_paper(kind, *q))).collect();
    let names = (1..=points.len()).map(|point| point.to_string()).collect();
    let key_points = Series::of("key point", Role::Named, 1, points).named(names);
    let [position, speed, name] = if kind == JointKind::Slides {
        ["Position (mm)", "Speed (mm/s)", "position"]
    } else {
        ["Angle (deg)", "Speed (deg/s)", "angle"]
    };
    let panel = |label, as_what, values: &[f64], limits: [f64; 2]| {
        panel(
            label,
            as_what,
            values.iter().map(|v| hundredths(on_paper(kind, *v))).collect(),
            limits.map(|limit| on_paper(kind, limit)),
        )
    };
    let angle = panel(position, (name, Role::Measured), &motion.position_rad[k], motion.range_rad[k]);
    let mut speed =
        panel(speed, ("speed", Role::Error), &motion.velocity_rad_s[k], motion.speed_limit_rad_s[k]);
    let mut angle = Panel { share: 0.55, ..angle };
    speed.share = 0.45;
    angle.series.push(key_points);
    Chart {
        title: joint.to_owned(),
        note: used(k, course),
        x_label: "Time (s)".into(),
        xs: vec![shown(&motion.t_s), shown(&motion.arrivals_s), shown(&ends)],
        x_range: Some([-ROOM * ends[1], (1.0 + ROOM) * ends[1]]),
        panels: vec![angle, speed],
        group: Some("run"),
        height: 270,
        size: Size::Half,
        ..Chart::default()
    }
}

/// A quantity with those of its limits that are near.
fn panel(label: &str, (name, role): (&str, Role), values: Vec<f64>, limits: [f64; 2]) -> Panel {
    let [low, high] = span(values.iter().copied());
    let near = |limit: &f64| *limit >= low - NEAR * (high - low) && *limit <= high + NEAR * (high - low);
    let mut series = vec![Series::of(name, role, 0, values)];
    let guide = |limit: f64| Series::of("limit", Role::Guide, 2, vec![hundredths(limit); 2]);
    series.extend(limits.into_iter().filter(near).map(guide));
    Panel::of(label.to_owned(), 0.5, series)
}

/// How much of its limits a joint uses, those that are used most.
fn used(joint: usize, course: &Course) -> String {
    let own = course.evaluation.margins.iter().filter(|margin| margin.joint == Some(joint));
    let mut own: Vec<_> = own.filter(|margin| margin.limit != Limit::Position).collect();
    own.sort_by(|a, b| b.share.total_cmp(&a.share));
    let each = own
        .iter()
        .take(2)
        .map(|margin| format!("{:.0} % of its {}", 100.0 * margin.share, margin.limit.name_of(margin.kind)));
    let each: Vec<String> = each.collect();
    if each.is_empty() { String::new() } else { format!("uses {}", each.join(", ")) }
}

/// The way of the tool, coloured by its speed, over that of another plan.
pub(super) fn path(motion: &SampledMotion, beside: &SampledMotion, tool: &str) -> Scene {
    let spot = |of: &SampledMotion| of.tool_m.iter().map(|place| place.map(millimetres)).collect();
    Scene {
        title: format!("Path of the tool (link {tool})"),
        names: ["chosen plan", "shown plan at"],
        unit: "mm",
        value_unit: "mm/s",
        planned: spot(beside),
        measured: spot(motion),
        value: motion.tool_speed_m_s.iter().map(|speed| millimetres(*speed)).collect(),
        yaw: broadest_rad(&beside.tool_m),
    }
}

fn shown(values: &[f64]) -> Vec<f64> {
    values.iter().copied().map(hundredths).collect()
}
