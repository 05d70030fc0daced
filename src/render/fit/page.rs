//! What a fit says of the machine: its numbers with their intervals.

use maud::{Markup, html};

use super::tables::{left_out_line, machine};
use crate::{
    fit::Fit,
    render::kit::{clean, page::headed},
};

pub(in crate::render) fn fitted(fit: &Fit) -> Markup {
    html! {
        p class="hint" { "The closed loop of each joint as identified from logs, with 95 % intervals." }
        @for section in machine(fit) { (headed(&section)) }
        p { (format!("90 % of held-out peaks stay below {:.2} times the predicted ones.", fit.peak_margin)) }
        @if let Some(line) = left_out_line(fit) { p { (clean(&line)) } }
    }
}
