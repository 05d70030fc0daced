//! What a fit says of the machine: its numbers with their intervals.

use maud::{Markup, html};

use super::parts::parts;
use crate::{
    fit::Fit,
    render::{
        fit::{left_out_line, machine_parts},
        markup::clean,
    },
};

pub(super) fn fitted(fit: &Fit) -> Markup {
    html! {
        p class="hint" { "The closed loop of each joint as logs show it, with 95 % intervals." }
        (parts(&machine_parts(fit)))
        p { (format!("Nine of ten held-out peaks lay below {:.2} times the predicted ones.", fit.peak_margin)) }
        @if let Some(line) = left_out_line(fit) { p { (clean(&line)) } }
    }
}
