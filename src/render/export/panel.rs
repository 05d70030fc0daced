//! Panels of Foxglove and how they divide the window.

use std::collections::BTreeMap;

use serde::Serialize;

/// A layout as Foxglove and Lichtblick import it.
#[derive(Debug, Serialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Layout {
    config_by_id: BTreeMap<String, Panel>,
    global_variables: BTreeMap<String, String>,
    user_nodes: BTreeMap<String, String>,
    playback_config: Playback,
    #[serde(rename = "layout", skip_serializing_if = "Option::is_none")]
    root: Option<Node>,
}

#[derive(Debug, Serialize)]
struct Playback {
    speed: u8,
}

#[derive(Debug, Serialize)]
#[serde(untagged)]
pub(super) enum Panel {
    Plot(Plot),
    Tabs(Tabs),
    ThreeD(ThreeD),
}

/// A panel by its id, or two parts of the window.
#[derive(Debug, Clone, Serialize)]
#[serde(untagged)]
pub(super) enum Node {
    Panel(String),
    #[serde(rename_all = "camelCase")]
    Split {
        first: Box<Self>,
        second: Box<Self>,
        direction: &'static str,
        split_percentage: f64,
    },
}

#[derive(Debug, Serialize)]
#[serde(rename_all = "camelCase")]
#[expect(clippy::struct_excessive_bools, reason = "as Foxglove has it")]
pub(super) struct Plot {
    #[serde(rename = "foxglovePanelTitle")]
    title: String,
    paths: Vec<Drawn>,
    x_axis_val: &'static str,
    y_axis_label: &'static str,
    is_synced: bool,
    show_legend: bool,
    legend_display: &'static str,
    show_plot_values_in_legend: bool,
    show_x_axis_labels: bool,
    show_y_axis_labels: bool,
    sidebar_dimension: u16,
    #[serde(skip_serializing_if = "Option::is_none")]
    min_x_value: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    max_x_value: Option<f64>,
}

/// A line of a plot.
#[derive(Debug, Serialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Drawn {
    pub(super) value: String,
    pub(super) enabled: bool,
    pub(super) timestamp_method: &'static str,
    pub(super) label: String,
    pub(super) color: &'static str,
}

#[derive(Debug, Serialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Tabs {
    active_tab_idx: usize,
    tabs: Vec<Tab>,
}

#[derive(Debug, Serialize)]
pub(super) struct Tab {
    pub(super) title: String,
    pub(super) layout: Node,
}

#[derive(Debug, Serialize)]
pub(super) struct ThreeD {
    #[serde(rename = "foxglovePanelTitle")]
    title: &'static str,
    layers: BTreeMap<String, Layer>,
}

/// The grid, or a robot.
#[derive(Debug, Serialize)]
#[serde(rename_all = "camelCase")]
struct Layer {
    #[serde(rename = "layerId")]
    kind: &'static str,
    instance_id: String,
    label: String,
    visible: bool,
    frame_locked: bool,
    order: usize,
    #[serde(flatten)]
    robot: Option<Robot>,
}

#[derive(Debug, Serialize)]
#[serde(rename_all = "camelCase")]
struct Robot {
    source_type: &'static str,
    topic: String,
    frame_prefix: &'static str,
    display_mode: &'static str,
}

impl Plot {
    /// With a window its time is its own, else it moves with that of the others.
    pub(super) fn new(
        title: String,
        unit: &'static str,
        paths: Vec<Drawn>,
        window_s: Option<[f64; 2]>,
    ) -> Self {
        Self {
            title,
            paths,
            x_axis_val: "timestamp",
            y_axis_label: unit,
            is_synced: window_s.is_none(),
            show_legend: true,
            legend_display: "floating",
            show_plot_values_in_legend: false,
            show_x_axis_labels: true,
            show_y_axis_labels: true,
            sidebar_dimension: 240,
            min_x_value: window_s.map(|[from_s, _]| from_s),
            max_x_value: window_s.map(|[_, to_s]| to_s),
        }
    }
}

impl ThreeD {
    /// The robots of some topics on a grid.
    pub(super) fn of(descriptions: &[String]) -> Self {
        let layer = |kind, id: String, label: String, order, robot| {
            let layer = Layer {
                kind,
                instance_id: id.clone(),
                label,
                visible: true,
                frame_locked: true,
                order,
                robot,
            };
            (id, layer)
        };
        let grid = layer("foxglove.Grid", "grid".to_owned(), "Grid".to_owned(), 1, None);
        let robots = descriptions.iter().enumerate().map(|(number, topic)| {
            let robot =
                Robot { source_type: "topic", topic: topic.clone(), frame_prefix: "", display_mode: "auto" };
            layer("foxglove.Urdf", format!("robot{}", number + 1), topic.clone(), number + 2, Some(robot))
        });
        Self { title: "Arm", layers: std::iter::once(grid).chain(robots).collect() }
    }
}

impl From<Plot> for Panel {
    fn from(plot: Plot) -> Self {
        Self::Plot(plot)
    }
}

impl From<ThreeD> for Panel {
    fn from(panel: ThreeD) -> Self {
        Self::ThreeD(panel)
    }
}

/// Panels by id.
#[derive(Debug, Default)]
pub(super) struct Panels(BTreeMap<String, Panel>);

impl Panels {
    /// Adds one; ids are distinct.
    pub(super) fn add(&mut self, kind: &str, id: &str, panel: impl Into<Panel>) -> Node {
        let id = format!("{kind}!{id}");
        self.0.insert(id.clone(), panel.into());
        Node::Panel(id)
    }

    /// Adds tabs, if there are any.
    pub(super) fn tabs(&mut self, id: &str, tabs: Vec<Tab>) -> Option<Node> {
        (!tabs.is_empty()).then(|| {
            let panel = Panel::Tabs(Tabs { active_tab_idx: 0, tabs });
            self.add("Tab", id, panel)
        })
    }

    pub(super) fn finish(self, root: Option<Node>) -> Layout {
        Layout {
            config_by_id: self.0,
            global_variables: BTreeMap::new(),
            user_nodes: BTreeMap::new(),
            playback_config: Playback { speed: 1 },
            root,
        }
    }
}

/// Parts above one another, each with its share.
pub(super) fn column(parts: Vec<(f64, Node)>) -> Option<Node> {
    split(parts, "column")
}

/// Parts beside one another, each with its share.
pub(super) fn row(parts: Vec<(f64, Node)>) -> Option<Node> {
    split(parts, "row")
}

/// Equal parts in rows; `None` for no parts.
pub(super) fn grid(nodes: &[Node], columns: usize) -> Option<Node> {
    let equal = |nodes: &[Node]| nodes.iter().map(|node| (1.0, node.clone())).collect();
    let rows: Vec<Node> = nodes.chunks(columns.max(1)).filter_map(|part| row(equal(part))).collect();
    column(equal(&rows))
}

fn split(parts: Vec<(f64, Node)>, direction: &'static str) -> Option<Node> {
    let mut parts = parts.into_iter().rev();
    let (mut below, mut node) = parts.next()?;
    for (share, first) in parts {
        below += share;
        let split_percentage = 100.0 * share / below;
        node = Node::Split { first: Box::new(first), second: Box::new(node), direction, split_percentage };
    }
    Some(node)
}
