//! Layouts for programs that open the log itself.

mod message_path;
mod panel;

use std::path::{Path, PathBuf};

use crate::{
    log::{Line, LineRole},
    render::kit::clean,
    series::JointKind,
    text::shell_argument,
    workflow::export::{Chart, Charts, Shown, Worst},
};
use message_path::{Modifier, message_path};
use panel::{Node, Panels};
use serde_json::Value;

/// Panels beside one another in a tab of many.
const COLUMNS: usize = 2;

/// Safe for colour-blind readers (Okabe and Ito 2008).
const PLANNED: &str = "#56b4e9";
const MEASURED: &str = "#e69f00";
const COMMAND: &str = "#009e73";
const JOINTS: [&str; 7] = ["#e69f00", "#56b4e9", "#009e73", "#f0e442", "#648fff", "#d55e00", "#cc79a7"];

pub(crate) fn foxglove(charts: &Charts) -> Value {
    let mut panels = Panels::default();
    let mut left = Vec::new();
    if !charts.descriptions.is_empty() {
        left.push((3.0, panels.add("3D", "arm", panel::arm(&charts.descriptions))));
    }
    let whole = |shown: Shown| charts.charts.iter().filter(move |chart| chart.shown == shown);
    for (number, chart) in whole(Shown::Error).enumerate() {
        left.extend(
            plot(charts, chart, None)
                .map(|plot| (2.0, panels.add("Plot", &format!("error{}", number + 1), plot))),
        );
    }
    left.extend(worst(charts, &mut panels).map(|node| (2.0, node)));
    let mut tabs = Vec::new();
    for (shown, title, id) in [
        (Shown::Position, "Joints", "position"),
        (Shown::Speed, "Speeds", "speed"),
        (Shown::Valve, "Valves", "valve"),
        (Shown::Pressure, "Pressures", "pressure"),
        (Shown::Effort, "Efforts", "effort"),
    ] {
        let plots = whole(shown).filter_map(|chart| plot(charts, chart, None));
        let nodes =
            plots.enumerate().map(|(number, plot)| panels.add("Plot", &format!("{id}{}", number + 1), plot));
        if let Some(layout) = panel::grid(&nodes.collect::<Vec<_>>(), COLUMNS) {
            tabs.push((title, layout));
        }
    }
    let right = panels.tabs("signals", &tabs);
    let nodes = [panel::column(left), right].into_iter().flatten().map(|node| (1.0, node)).collect();
    panels.finish(panel::row(nodes).as_ref())
}

pub(crate) fn foxglove_written(file: &Path) -> String {
    format!(
        "{} written; open the log in Foxglove or Lichtblick, then import this as a layout.\n",
        file.display()
    )
}

pub(crate) fn rerun_written(logs: &[PathBuf], file: &Path) -> String {
    let logs: Vec<String> = logs.iter().map(shell_argument).collect();
    format!("{} written; rerun {} {} opens both.\n", file.display(), logs.join(" "), shell_argument(file))
}

fn worst(charts: &Charts, panels: &mut Panels) -> Option<Node> {
    let worst = charts.worst.as_ref()?;
    let of_joint =
        |chart: &&Chart| chart.shown == Shown::Position && chart.joint.as_ref() == Some(&worst.joint);
    let chart = charts.charts.iter().find(of_joint)?;
    Some(panels.add("Plot", "worst", plot(charts, chart, Some(worst))?))
}

/// A chart as a plot; `None` if none of its lines has a path.
fn plot(charts: &Charts, chart: &Chart, near: Option<&Worst>) -> Option<Value> {
    let (unit, modifier) = unit(chart.shown, chart.kind);
    let drawn = |(number, line): (usize, &Line)| {
        let topic = charts.topics.get(line.topic)?;
        let by = if charts.by_header && topic.stamped { "headerStamp" } else { "receiveTime" };
        let path = message_path(&topic.topic, &line.path, modifier)?;
        Some(panel::drawn(&path, by, &clean(&label(chart, line)), color(line.role, number)))
    };
    let paths: Vec<Value> = chart.lines.iter().enumerate().filter_map(drawn).collect();
    let title = match near {
        Some(worst) => format!("Worst start: {}, {:.1} s", worst.joint, worst.at_s),
        None => chart.joint.clone().unwrap_or_else(|| title(chart.shown).to_owned()),
    };
    (!paths.is_empty()).then(|| panel::plot(&clean(&title), unit, &paths, near.map(|worst| worst.window_s)))
}

fn title(shown: Shown) -> &'static str {
    match shown {
        Shown::Position => "Position",
        Shown::Error => "Error: planned minus measured",
        Shown::Speed => "Speed",
        Shown::Valve => "Signals to the valves",
        Shown::Pressure => "Pressures",
        Shown::Effort => "Efforts",
    }
}

fn unit(shown: Shown, kind: JointKind) -> (&'static str, Modifier) {
    match (shown, kind) {
        (Shown::Position | Shown::Error, JointKind::Turns) => ("deg", Modifier::Degrees),
        (Shown::Position | Shown::Error, JointKind::Slides) => ("m", Modifier::None),
        (Shown::Speed, JointKind::Turns) => ("deg/s", Modifier::Degrees),
        (Shown::Speed, JointKind::Slides) => ("m/s", Modifier::None),
        (Shown::Valve, _) => ("share of the full signal", Modifier::None),
        (Shown::Pressure, _) => ("Pa", Modifier::None),
        (Shown::Effort, JointKind::Turns) => ("N m", Modifier::None),
        (Shown::Effort, JointKind::Slides) => ("N", Modifier::None),
    }
}

fn label(chart: &Chart, line: &Line) -> String {
    let word = match line.role {
        LineRole::Planned | LineRole::PlannedSpeed => "planned",
        LineRole::Measured | LineRole::MeasuredSpeed => "measured",
        LineRole::Command => "command",
        LineRole::CapPressure => "cap side",
        LineRole::RodPressure => "rod side",
        LineRole::SupplyPressure => "supply",
        LineRole::Error | LineRole::Valve | LineRole::Effort => "",
    };
    if chart.joint.is_some() { word.to_owned() } else { line.joint.clone() }
}

fn color(role: LineRole, number: usize) -> &'static str {
    match role {
        LineRole::Planned | LineRole::PlannedSpeed => PLANNED,
        LineRole::Measured | LineRole::MeasuredSpeed => MEASURED,
        LineRole::Command => COMMAND,
        _ => JOINTS[number % JOINTS.len()],
    }
}
