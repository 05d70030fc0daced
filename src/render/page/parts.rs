//! The third rendering of report parts: as HTML.

use maud::{Markup, html};

use crate::render::{Part, Sheet, markup::clean};

/// Headings, sentences, facts and tables; titles are the page's own.
pub(super) fn parts(parts: &[Part]) -> Markup {
    html! {
        @for part in parts {
            @match part {
                Part::Title(_) => {}
                Part::Heading(title) => { h3 { (clean(title)) } }
                Part::Line(line) => { p { (clean(line)) } }
                Part::Facts(facts) => { (list(facts)) }
                Part::Sheet(sheet) => { (table(sheet)) }
            }
        }
    }
}

fn list(facts: &[(String, String)]) -> Markup {
    html! {
        dl class="list" { @for (name, value) in facts { dt { (clean(name)) } dd { (clean(value)) } } }
    }
}

/// A table that scrolls by itself where the screen is narrow.
pub(super) fn table(sheet: &Sheet) -> Markup {
    let class = |column: usize| if column < sheet.left { "word" } else { "number" };
    html! {
        div class="scroll" tabindex="0" {
            table {
                thead { tr { @for (i, head) in sheet.head.iter().enumerate() { th class=(class(i)) { (head) } } } }
                tbody {
                    @for row in &sheet.rows {
                        tr { @for (i, cell) in row.iter().enumerate() { td class=(class(i)) { (clean(cell)) } } }
                    }
                }
            }
        }
    }
}
