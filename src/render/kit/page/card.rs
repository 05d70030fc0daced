//! Boxes at the top of a page.

use maud::{Markup, html};

use crate::render::kit::{Sentence, clean};

/// A box with a headline.
pub(in crate::render) fn card(class: &str, label: &str, headline: &str, body: &Markup) -> Markup {
    html! {
        div class={ "card " (class) } {
            p class="label" { (label) }
            p class="headline" { (clean(headline)) }
            (body)
        }
    }
}

/// Whether limits are kept, each with a line; `option` sets one where there is none.
pub(in crate::render) fn verdict(kept: &[bool], lines: &[String], option: &str) -> Markup {
    let broken = kept.iter().filter(|kept| !**kept).count();
    let (class, headline) = match (kept.len(), broken) {
        (0, _) => ("open", "No limits set".to_owned()),
        (1, 0) => ("good", "The limit is kept".to_owned()),
        (all, 0) => ("good", format!("All {all} limits kept")),
        (all, broken) => ("bad", format!("{broken} of {all} limits NOT kept")),
    };
    let body = html! {
        @if kept.is_empty() {
            p { "Nothing says whether this is good enough; a limit such as " code { (option) } " would." }
        } @else {
            ul { @for line in lines { li { (clean(line)) } } }
        }
    };
    card(class, "Verdict", &headline, &body)
}

/// What to do, in order.
pub(in crate::render) fn next_steps(steps: &[Sentence]) -> Markup {
    html! {
        h3 { "What to do next" }
        ol class="next" { @for step in steps { li { (clean(&step.to_string())) } } }
    }
}
