//! Rows with a bar or an interval each, on one common scale.

use maud::{Markup, html};

use super::chart::span;
use crate::render::kit::clean;

/// A number with what is known of it.
pub(in crate::render) struct Row {
    pub(in crate::render) name: String,
    pub(in crate::render) value: f64,
    pub(in crate::render) interval: Option<[f64; 2]>,
    pub(in crate::render) text: String,
    pub(in crate::render) strong: bool,
}

/// Thousandths of the width: the drawing is stretched, so it holds no text.
const WIDTH: f64 = 1000.0;

/// Bars from zero.
pub(in crate::render) fn bars(rows: &[Row]) -> Markup {
    strips(rows, true)
}

/// Points with their intervals; zero is marked where it lies within.
pub(in crate::render) fn intervals(rows: &[Row]) -> Markup {
    strips(rows, false)
}

fn strips(rows: &[Row], bars: bool) -> Markup {
    let ends = rows.iter().flat_map(|row| row.interval.into_iter().flatten().chain([row.value, 0.0]));
    let [low, high] = span(ends);
    let room = if bars { 0.0 } else { 0.03 * (high - low) };
    let place = |value: f64| ((value - low + room) / (high - low + 2.0 * room) * WIDTH).clamp(0.0, WIDTH);
    let fixed = |value: f64| format!("{value:.1}");
    html! {
        table class="strips" {
            @for row in rows {
                tr {
                    th { (clean(&row.name)) }
                    td class="strip" {
                        svg viewBox="0 0 1000 20" preserveAspectRatio="none" aria-hidden="true" {
                            line class="zero" x1=(fixed(place(0.0))) x2=(fixed(place(0.0))) y1="0" y2="20" {}
                            @if bars {
                                rect class=(if row.strong { "bar strong" } else { "bar" }) x="0" y="4"
                                    width=(fixed(place(row.value))) height="12" {}
                            } @else {
                                @if let Some([a, b]) = row.interval {
                                    line class="interval" x1=(fixed(place(a))) x2=(fixed(place(b))) y1="10" y2="10" {}
                                }
                                rect class=(if row.strong { "mark strong" } else { "mark" })
                                    x=(fixed(place(row.value) - 4.0)) y="3" width="8" height="14" {}
                            }
                        }
                    }
                    td class="number" { (clean(&row.text)) }
                }
            }
        }
    }
}
