//! Panels of Foxglove and how they divide the window.

use std::collections::BTreeMap;

use serde::Serialize;
use serde_json::{Value, json};

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

/// A plot of lines in a unit. With a window its time is its own, else it moves with that of the others.
pub(super) fn plot(title: &str, unit: &str, paths: &[Value], window_s: Option<[f64; 2]>) -> Value {
    let mut plot = json!({
        "foxglovePanelTitle": title,
        "paths": paths,
        "xAxisVal": "timestamp",
        "yAxisLabel": unit,
        "isSynced": window_s.is_none(),
        "showLegend": true,
        "legendDisplay": "floating",
        "showPlotValuesInLegend": false,
        "showXAxisLabels": true,
        "showYAxisLabels": true,
        "sidebarDimension": 240,
    });
    if let Some([from_s, to_s]) = window_s {
        plot["minXValue"] = json!(from_s);
        plot["maxXValue"] = json!(to_s);
    }
    plot
}

pub(super) fn drawn(value: &str, by: &str, label: &str, color: &str) -> Value {
    json!({ "value": value, "enabled": true, "timestampMethod": by, "label": label, "color": color })
}

/// The robots of some topics on a grid.
pub(super) fn arm(descriptions: &[String]) -> Value {
    let layer = |kind: &str, id: &str, label: &str, order: usize| {
        json!({
            "layerId": kind, "instanceId": id, "label": label, "visible": true, "frameLocked": true, "order": order,
        })
    };
    let mut layers = json!({ "grid": layer("foxglove.Grid", "grid", "Grid", 1) });
    for (number, topic) in descriptions.iter().enumerate() {
        let id = format!("robot{}", number + 1);
        let mut robot = layer("foxglove.Urdf", &id, topic, number + 2);
        for (key, value) in
            [("sourceType", "topic"), ("topic", topic), ("framePrefix", ""), ("displayMode", "auto")]
        {
            robot[key] = json!(value);
        }
        layers[id] = robot;
    }
    json!({ "foxglovePanelTitle": "Arm", "layers": layers })
}

#[derive(Debug, Default)]
pub(super) struct Panels(BTreeMap<String, Value>);

impl Panels {
    /// Adds one; ids are distinct.
    pub(super) fn add(&mut self, kind: &str, id: &str, panel: Value) -> Node {
        let id = format!("{kind}!{id}");
        self.0.insert(id.clone(), panel);
        Node::Panel(id)
    }

    /// Adds tabs, each a title and what it shows, if there are any.
    pub(super) fn tabs(&mut self, id: &str, tabs: &[(&str, Node)]) -> Option<Node> {
        let tabs: Vec<Value> =
            tabs.iter().map(|(title, layout)| json!({ "title": title, "layout": layout })).collect();
        (!tabs.is_empty()).then(|| self.add("Tab", id, json!({ "activeTabIdx": 0, "tabs": tabs })))
    }

    pub(super) fn finish(self, root: Option<&Node>) -> Value {
        let mut layout = json!({
            "configById": self.0, "globalVariables": {}, "userNodes": {}, "playbackConfig": { "speed": 1 },
        });
        if let Some(root) = root {
            layout["layout"] = json!(root);
        }
        layout
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
