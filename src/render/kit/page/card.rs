//! Boxes at the top of a page.

use maud::{Markup, html};

use crate::render::kit::{Sentence, clean};

pub(in crate::render) fn card(class: &str, label: &str, headline: &str, body: &Markup) -> Markup {
    html! {
        div class={ "card " (class) } {
            p class="label" { (label) }
            p class="headline" { (clean(headline)) }
            (body)
        }
    }
}

/// Whether limits are kept, each with a line; nothing where there are none.
pub(in crate::render) fn verdict(kept: &[bool], lines: &[String]) -> Markup {
    if kept.is_empty() {
        return html! {};
    }
    let broken = kept.iter().filter(|kept| !**kept).count();
    let (class, headline) = match (kept.len(), broken) {
        (1, 0) => ("good", "The limit is kept".to_owned()),
        (all, 0) => ("good", format!("All {all} limits kept")),
        (all, broken) => ("bad", format!("{broken} of {all} limits NOT kept")),
    };
    let body = html! {
        ul { @for line in lines { li { (clean(line)) } } }
    };
    card(class, "Verdict", &headline, &body)
}

/// What to do, in order, each with the line to type if there is one.
pub(in crate::render) fn next_steps(steps: &[(Sentence, Option<String>)]) -> Markup {
    html! {
        h3 { "What to do next" }
        ol class="next" {
            @for (step, line) in steps {
                li {
                    (clean(&step.to_string()))
                    @if let Some(line) = line { pre class=[is_form(line).then_some("form")] { code { (clean(line)) } } }
                }
            }
        }
    }
}

/// Whether a line has a word that the reader is to replace, as `NEXT_RUN`: it is not to be copied as it is.
fn is_form(line: &str) -> bool {
    line.split(' ')
        .any(|word| word.len() > 2 && word.bytes().all(|byte| byte.is_ascii_uppercase() || byte == b'_'))
}
