//! The document around the sections: head, styles, script, the data of all plots.

use base64::{Engine as _, engine::general_purpose::STANDARD};
use maud::{DOCTYPE, Markup, PreEscaped, html};
use sha2::{Digest, Sha256};

use super::{
    blocks,
    chart::{Chart, Role, Shade, embedded},
    paper::{self, Paper},
};
use crate::{
    document::PROGRAM,
    render::kit::{Document, Section, clean},
};

const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = concat!(
    include_str!("page.js"),
    include_str!("tools.js"),
    include_str!("scene.js"),
    include_str!("choice.js")
);

/// A part of the page that can be jumped to.
pub(in crate::render) struct Chapter {
    pub(in crate::render) id: &'static str,
    pub(in crate::render) heading: &'static str,
    pub(in crate::render) body: Markup,
}

impl Chapter {
    pub(in crate::render) fn new(id: &'static str, heading: &'static str, body: Markup) -> Self {
        Self { id, heading, body }
    }

    /// A section of the document under a heading of the page; `None` where the document has none.
    pub(in crate::render) fn of(section: Option<&Section>, heading: &'static str) -> Option<Self> {
        section.map(|section| Self { id: section.id.0, heading, body: blocks(&section.blocks) })
    }
}

/// Plots of a page, by the order in which they were placed.
#[derive(Default)]
pub(in crate::render) struct Plots(Vec<Chart>);

impl Plots {
    /// The place of a plot: the script draws on the screen, the picture is for paper.
    pub(in crate::render) fn place(&mut self, chart: Chart) -> Markup {
        // A plot that no picture can be drawn of is still drawn by the script.
        let picture = paper::svg(&chart, Paper::PAGE).unwrap_or_default();
        let picture = picture.replacen(" xmlns=\"http://www.w3.org/2000/svg\"", "", 1);
        self.placed(chart, &picture)
    }

    /// The place of a plot that is folded at first: no paper shows it.
    pub(in crate::render) fn folded(&mut self, chart: Chart) -> Markup {
        self.placed(chart, "")
    }

    fn placed(&mut self, chart: Chart, picture: &str) -> Markup {
        let number = self.0.len();
        let figure = html! {
            figure class=(if chart.is_tile() { "chart tile" } else { "chart" }) {
                figcaption {
                    span class="title" { (clean(&chart.title)) }
                    @if !chart.note.is_empty() { span class="note" { (clean(&chart.note)) } }
                    @if !chart.is_tile() { span class="legend" { (legend(&chart)) } }
                    span class="read" aria-live="polite" {}
                }
                div class="live" data-chart=(number) {}
                div class="paper" aria-hidden="true" { (PreEscaped(picture)) }
            }
        };
        self.0.push(chart);
        figure
    }
}

/// Names of the series beside their colours, each once.
fn legend(chart: &Chart) -> Markup {
    let mut shown: Vec<(&str, Role)> = Vec::new();
    for series in chart.panels.iter().flat_map(|panel| &panel.series) {
        let entry = (series.name.as_str(), series.role);
        if !series.name.is_empty() && !shown.contains(&entry) {
            shown.push(entry);
        }
    }
    html! {
        @for (name, role) in shown { span { i class=(class(role)) {} (clean(name)) } }
        @for shade in Shade::ALL {
            @let [name, class] = shade.names();
            @if chart.bands.iter().any(|band| band.shade == shade) { span { i class=(class) {} (name) } }
        }
    }
}

fn class(role: Role) -> &'static str {
    match role {
        Role::Planned => "planned",
        Role::Measured => "measured",
        Role::Error => "error",
        Role::Before => "before",
        Role::Command => "command",
        Role::Point => "point",
        Role::Named => "named",
        Role::Guide => "guide",
        Role::Band => "band",
    }
}

/// The whole page, with title and facts of its document. It fetches nothing, and runs nothing but its own script.
pub(in crate::render) fn page(
    kind: &str,
    document: &Document,
    chapters: &[Chapter],
    plots: &Plots,
) -> String {
    let policy = format!(
        "default-src 'none'; script-src {}; style-src {}; base-uri 'none'; form-action 'none'",
        hash(SCRIPT),
        hash(STYLE)
    );
    let title = clean(document.title.as_deref().unwrap_or_default());
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta http-equiv="Content-Security-Policy" content=(policy);
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                meta name="generator" content=(PROGRAM);
                title { (kind) ": " (title) }
                style { (PreEscaped(STYLE)) }
            }
            body {
                header {
                    p class="kind" { "hydrotrace " (kind) }
                    h1 { (title) }
                    dl class="facts" {
                        @for fact in &document.facts { div { dt { (clean(&fact.name)) } dd { (clean(&fact.value)) } } }
                    }
                    nav { @for section in chapters { a href={ "#" (section.id) } { (section.heading) } } }
                }
                main {
                    @for section in chapters {
                        section id=(section.id) { h2 { (section.heading) } (section.body) }
                    }
                }
                footer { "Made by " (PROGRAM) ". This page is one file and fetches nothing." }
                script id="data" type="application/json" { (PreEscaped(clean(&embedded(&plots.0)))) }
                script { (PreEscaped(SCRIPT)) }
            }
        }
    };
    page.into_string()
}

/// What a policy knows a script or a sheet of styles by.
fn hash(text: &str) -> String {
    format!("'sha256-{}'", STANDARD.encode(Sha256::digest(text)))
}
