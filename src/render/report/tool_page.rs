//! The tool on the page: a card, its error over time, and its path in space.

use maud::{Markup, html};

use super::tool::{ID, main_cause, section};
use crate::{
    render::{
        kit::{
            Column, Table, clean, deg, mm,
            page::{
                Plots, blocks, card,
                chart::{Chart, Panel, Role, Series, Size, at, millimetres, rounded, times},
                envelope::envelope,
                scene::{Scene, broadest_rad, scene},
                table,
            },
        },
        metric::on_paper,
    },
    replay::{ToolPath, ToolReplay},
    series::JointKind::{Slides, Turns},
    workflow::report::{Report, Tool},
};

/// Places of the plot and of the path at most, nearly.
const MOST: [usize; 2] = [4000, 1200];
/// Rows of the table that stands in for the path.
const ROWS: usize = 24;

/// What the tool did, for the top of the page; nothing where there is no arm.
pub(super) fn tool_card(tool: &Tool) -> Markup {
    let Some(found) = tool.found() else {
        let why = tool.why_not();
        return html! { @if let Some(why) = why { (card("", "At the tool", "Not known", &html! { p { (clean(&why)) } })) } };
    };
    let worst = &found.worst;
    let body = html! {
        @if let Some(end) = found.end() { p { (format!("{} mm when it came to rest at the end", mm(end.deviation.error_m))) } }
        @if let Some(cause) = main_cause(&worst.deviation) { p { (clean(&cause)) " of the worst" } }
        p { "RMS " (mm(found.rms_m)) " mm" @if let Some(rad) = found.worst_orientation_rad { ", orientation " (deg(rad)) " deg at worst" } }
        p { a href={ "#" (ID.0) } { "How, and by which joint" } }
    };
    let headline = format!("{} mm off at {:.1} s", mm(worst.deviation.error_m), worst.time_s);
    card("", "At the tool", &headline, &body)
}

/// Plot, path in space and numbers; `None` where nothing is known.
pub(super) fn tool_chapter(report: &Report, plots: &mut Plots, most: usize) -> Option<Markup> {
    let Tool::Placed(found, path) = &report.tool else { return None };
    let section = section(report, most)?;
    Some(html! {
        p class="hint" {
            "How far the tool is from where the plan has it at the same instant. The plot zooms with those of the joints."
        }
        (plots.place(error_chart(found, path)))
        (scene(&path_scene(found, path)))
        details { summary { "The path as a table" } (table(&path_table(path))) }
        (blocks(&section.blocks))
    })
}

pub(super) fn error_chart(found: &ToolReplay, path: &ToolPath) -> Chart {
    let places = envelope(&path.segments, &[&path.error_m, &path.along_m, &path.orientation_rad], MOST[0]);
    let shown =
        |values: &[f64], kind| at(values, &places).map(|value| rounded(on_paper(kind, value))).collect();
    let series = |name: &str, role, y| Series::of(name, role, 0, y);
    let distance = series("distance", Role::Error, shown(&path.error_m, Slides));
    let along = series("behind along the path", Role::Measured, shown(&path.along_m, Slides));
    let share = if found.rms_orientation_rad.is_some() { 0.65 } else { 1.0 };
    let mut panels = vec![Panel::of("Error (mm)", share, vec![distance, along])];
    if found.rms_orientation_rad.is_some() {
        let angle = series("orientation", Role::Before, shown(&path.orientation_rad, Turns));
        panels.push(Panel::of("Angle (deg)", 0.35, vec![angle]));
    }
    Chart {
        title: format!("Error at the tool (link {})", found.tool),
        note: format!("worst {} mm, rms {} mm", mm(found.worst.deviation.error_m), mm(found.rms_m)),
        x_label: "Time (s)".into(),
        xs: vec![times(&path.t_s, &places)],
        panels,
        group: Some("run"),
        height: 270,
        size: Size::Wide,
        ..Chart::default()
    }
}

fn path_scene(found: &ToolReplay, path: &ToolPath) -> Scene {
    let axis = |of: &[[f64; 3]], k: usize| of.iter().map(|place| place[k]).collect::<Vec<f64>>();
    let [x, y, z] = [0, 1, 2].map(|k| axis(&path.measured_m, k));
    let places = envelope(&path.segments, &[&path.error_m, &x, &y, &z], MOST[1]);
    let spot = |of: &[[f64; 3]]| {
        let place = |place: &Option<usize>| place.map_or([f64::NAN; 3], |i| of[i].map(millimetres));
        places.iter().map(place).collect::<Vec<_>>()
    };
    Scene {
        title: format!("Path of the tool (link {})", found.tool),
        names: ["planned", "measured, off by"],
        unit: "mm",
        value_unit: "mm",
        planned: spot(&path.planned_m),
        measured: spot(&path.measured_m),
        value: at(&path.error_m, &places).map(millimetres).collect(),
        yaw: broadest_rad(&path.planned_m),
    }
}

/// The worst instant of each of some stretches of the run.
fn path_table(path: &ToolPath) -> Table {
    let size = path.t_s.len().div_ceil(ROWS).max(1);
    let row = |start: usize| {
        let own = start..(start + size).min(path.t_s.len());
        let i = own.clone().max_by(|a, b| path.error_m[*a].total_cmp(&path.error_m[*b])).unwrap_or(start);
        let mut cells =
            vec![format!("{:.2}", path.t_s[start]), format!("{:.2}", path.t_s[i]), mm(path.error_m[i])];
        cells.extend(path.planned_m[i].iter().chain(&path.measured_m[i]).map(|m| format!("{:.0}", 1e3 * m)));
        cells
    };
    let headings = ["from s", "worst at s", "off mm", "planned x mm", "y", "z", "measured x mm", "y", "z"]
        .map(Column::numbers);
    Table::of(headings, (0..path.t_s.len()).step_by(size).map(row).collect::<Vec<_>>())
}
