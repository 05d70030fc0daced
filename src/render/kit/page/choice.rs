//! Things of which the reader chooses one, by a point of a plot or a slider: what is shown is then that one.

use maud::{Markup, PreEscaped, html};
use serde::Serialize;

use super::chart::Chart;
use crate::render::kit::clean;

#[derive(Debug, Clone, Serialize)]
pub(in crate::render) struct Choice {
    pub(in crate::render) name: String,
    pub(in crate::render) lines: Vec<String>,
    /// What to type for it; empty where no line makes it.
    pub(in crate::render) command: String,
    /// Its point in every plot of points: which series, and where in it.
    pub(in crate::render) point: [usize; 2],
    /// What the plots of the group `run` then are, in their order.
    pub(in crate::render) charts: Vec<Chart>,
    /// What the path of the scene then is, and the value along it.
    pub(in crate::render) path: Vec<[f64; 3]>,
    pub(in crate::render) value: Vec<f64>,
}

/// The slider with what is said of the one that is shown, the first; without a script only that.
pub(in crate::render) fn choice(label: &str, choices: &[Choice]) -> Markup {
    let Some(first) = choices.first() else { return html! {} };
    let data = serde_json::to_string(choices).unwrap_or_else(|_| "[]".to_owned()).replace('<', "\\u003c");
    html! {
        div class="choice" {
            label {
                span { (label) }
                input type="range" min="0" max=(choices.len() - 1) value="0" aria-valuetext=(clean(&first.name));
                strong { (clean(&first.name)) }
            }
            ul { @for line in &first.lines { li { (clean(line)) } } }
            pre hidden[first.command.is_empty()] { code { (clean(&first.command)) } }
        }
        script id="choices" type="application/json" { (PreEscaped(clean(&data))) }
    }
}
