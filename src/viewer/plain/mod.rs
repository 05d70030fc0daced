//! A blueprint for what Rerun itself reads of a log: the entities and components of its MCAP reader.

mod drawn;

use std::{io::Write as _, path::Path};

use rerun::{
    ApplicationId,
    blueprint::components::{Corner2D, LinkAxis, PanelState},
    blueprint::{
        Blueprint, BlueprintPanel, ContainerLike, Grid, Horizontal, SelectionPanel, Spatial3DView, Tabs,
        TimePanel, TimeSeriesView, Vertical,
    },
    external::re_sdk_types::blueprint::archetypes::{PlotLegend, TimeAxis},
};

use super::{ViewError, board::Board, color};
use crate::{
    atomic_file::write_atomically,
    log::LineRole,
    series::JointKind,
    workflow::export::{Chart, Charts, Shown},
};
use drawn::Drawn;

/// Writes a blueprint for `rerun LOG FILE`.
pub(crate) fn write_blueprint(charts: &Charts, file: &Path) -> Result<(), ViewError> {
    let bytes = of(charts).ok_or(ViewError::Undrawn)?.bytes(&application(charts))?;
    write_atomically::<_, ViewError>(file, |out| out.write_all(&bytes).map_err(ViewError::Write))
}

/// What Rerun calls a file that it opens: by this name a blueprint finds its recording.
fn application(charts: &Charts) -> ApplicationId {
    let name = charts.files.first().map_or("", String::as_str);
    let stem = Path::new(name).file_stem().unwrap_or_default().to_string_lossy();
    ApplicationId::new_or_unknown(stem.replace('.', "_"))
}

/// `None` if Rerun draws none of the lines.
fn of(charts: &Charts) -> Option<Board> {
    let mut board = Board::default();
    let mut left: Vec<(f32, ContainerLike)> = Vec::new();
    if !charts.descriptions.is_empty() {
        let view = Spatial3DView::new("Arm: measured, and planned if the log has it");
        left.push((2.0, view.with_origin("/").with_contents(["+ /**"]).into()));
    }
    let whole = |shown: Shown| charts.charts.iter().filter(move |chart| chart.shown == shown);
    for chart in whole(Shown::Error) {
        left.extend(plot(&mut board, charts, chart).map(|view| (1.2, view)));
    }
    let mut tabs: Vec<ContainerLike> = Vec::new();
    for (shown, title) in [
        // The legend is not shown, and titles of small views are cut.
        (Shown::Position, "Joints: planned blue, measured orange, command green"),
        (Shown::Speed, "Speeds"),
        (Shown::Valve, "Valves"),
        (Shown::Pressure, "Pressures"),
        (Shown::Effort, "Efforts"),
    ] {
        let views: Vec<ContainerLike> =
            whole(shown).filter_map(|chart| plot(&mut board, charts, chart)).collect();
        if !views.is_empty() {
            let columns = if views.len() > 1 { 2 } else { 1 };
            tabs.push(Grid::new(views).with_grid_columns(columns).with_name(title).into());
        }
    }
    if tabs.is_empty() {
        return None;
    }
    let tabs: ContainerLike = Tabs::new(tabs).into();
    let root: ContainerLike = if left.is_empty() {
        tabs
    } else {
        let (shares, views): (Vec<f32>, Vec<ContainerLike>) = left.into_iter().unzip();
        let left = Vertical::new(views).with_row_shares(shares).into();
        Horizontal::new([left, tabs]).with_column_shares(vec![1.0, 1.3]).into()
    };
    let timeline = if charts.by_header { "ros2_timestamp" } else { "message_log_time" };
    Some(board.finish(|| {
        Blueprint::new(root)
            .with_auto_views(false)
            .with_auto_layout(false)
            .with_blueprint_panel(BlueprintPanel::from_state(PanelState::Collapsed))
            .with_selection_panel(SelectionPanel::from_state(PanelState::Collapsed))
            .with_time_panel(TimePanel::new().with_timeline(timeline).with_state(PanelState::Collapsed))
    }))
}

/// A chart as a view; `None` if Rerun draws none of its lines.
fn plot(board: &mut Board, charts: &Charts, chart: &Chart) -> Option<ContainerLike> {
    let mut view = TimeSeriesView::new(title(chart)).with_origin("/");
    let mut seen = Vec::new();
    let mut hides = false;
    for (number, line) in chart.lines.iter().enumerate() {
        let Some(drawn) = charts.topics.get(line.topic).and_then(|topic| Drawn::of(topic, line)) else {
            continue;
        };
        let name = if chart.joint.is_some() { word(line.role) } else { line.joint.as_str() };
        let color = match line.role {
            LineRole::Planned | LineRole::PlannedSpeed => color::joint(1),
            LineRole::Measured | LineRole::MeasuredSpeed => color::run(0),
            LineRole::Command => color::joint(2),
            _ => color::joint(number),
        };
        let query = format!("+ {}", drawn.entity);
        if !seen.contains(&query) {
            seen.push(query);
        }
        // All joints of an entity in one chart need no choice, and keep their names in the legend.
        if chart.joint.is_some() || !drawn.hides() {
            hides |= drawn.hides();
            view = view.with_override(drawn.entity.as_str(), drawn.visualizer(name, color));
        }
    }
    if seen.is_empty() {
        return None;
    }
    // A legend would list the joints that are hidden, too.
    let legend = PlotLegend::new().with_corner(Corner2D::LeftTop).with_visible(!hides);
    let view = board.with(view.with_contents(seen), &legend);
    Some(board.with(view, &TimeAxis::new().with_link(LinkAxis::LinkToGlobal)))
}

fn title(chart: &Chart) -> String {
    let turns = chart.kind == JointKind::Turns;
    let (what, unit) = match chart.shown {
        Shown::Position => ("Position", if turns { "rad" } else { "m" }),
        Shown::Error => ("Error, planned minus measured", if turns { "rad" } else { "m" }),
        Shown::Speed => ("Speed", if turns { "rad/s" } else { "m/s" }),
        Shown::Valve => ("Signals to the valves", "share"),
        Shown::Pressure => ("Pressures", "Pa"),
        Shown::Effort => ("Efforts", if turns { "N m" } else { "N" }),
    };
    format!("{}, {unit}", chart.joint.as_deref().unwrap_or(what))
}

fn word(role: LineRole) -> &'static str {
    match role {
        LineRole::Planned | LineRole::PlannedSpeed => "planned",
        LineRole::Measured | LineRole::MeasuredSpeed => "measured",
        LineRole::Command => "command",
        LineRole::Error => "error",
        LineRole::Valve => "valve",
        LineRole::CapPressure => "cap side",
        LineRole::RodPressure => "rod side",
        LineRole::SupplyPressure => "supply",
        LineRole::Effort => "effort",
    }
}
