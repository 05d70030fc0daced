//! Blocks of a document as HTML.

use maud::{Markup, html};

use crate::render::kit::{Align, Block, Check, Fact, Section, Table, clean};

/// A section within a chapter.
pub(in crate::render) fn headed(section: &Section) -> Markup {
    html! {
        @if let Some(heading) = &section.heading { h3 { (clean(heading)) } }
        (blocks(&section.blocks))
    }
}

/// Sentences, facts and tables.
pub(in crate::render) fn blocks(blocks: &[Block]) -> Markup {
    blocks_of(blocks, &[])
}

/// The same; rows of tables show their stretches in the plots of the run.
pub(in crate::render) fn blocks_of(blocks: &[Block], stretches: &[Stretch]) -> Markup {
    html! {
        @for block in blocks {
            @match block {
                Block::Sentence(sentence) => { p { (clean(&sentence.to_string())) } }
                Block::Facts(facts) => { (list(facts)) }
                Block::Remarks(facts) => { div class="remarks" { (list(facts)) } }
                Block::Checks(checks) => { (checked(checks)) }
                Block::Table(whole) => { (table_of(whole, stretches)) }
                Block::Command(line) => { pre { code { (clean(line)) } } }
            }
        }
    }
}

fn checked(checks: &[Check]) -> Markup {
    html! {
        ul class="checks" {
            @for Check { mark, name, found } in checks {
                li class=(mark.class()) {
                    span class="mark" { (mark.word()) }
                    b { (name) }
                    span { (clean(found)) }
                }
            }
        }
    }
}

fn list(facts: &[Fact]) -> Markup {
    html! {
        dl class="list" {
            @for Fact { name, value } in facts { dt { (clean(name)) } dd { (clean(value)) } }
        }
    }
}

/// A stretch of the run that a row is about.
#[derive(Debug, Clone)]
pub(in crate::render) struct Stretch {
    pub(in crate::render) joint: String,
    pub(in crate::render) from_s: f64,
    pub(in crate::render) to_s: f64,
}

/// A table that scrolls by itself where the screen is narrow.
pub(in crate::render) fn table(table: &Table) -> Markup {
    table_of(table, &[])
}

fn table_of(table: &Table, stretches: &[Stretch]) -> Markup {
    let class = |k: usize| match table.columns.get(k).map(|column| column.align) {
        Some(Align::Left) => "word",
        _ => "number",
    };
    html! {
        div class="scroll" tabindex="0" {
            table {
                thead { tr {
                    @for (k, column) in table.columns.iter().enumerate() {
                        @if column.heading.is_empty() { td {} } @else {
                            th class=(class(k)) title=[(!column.meaning.is_empty()).then_some(column.meaning)] {
                                (clean(&column.heading))
                            }
                        }
                    }
                } }
                tbody {
                    @for (n, row) in table.rows.iter().enumerate() {
                        @let of = stretches.get(n);
                        tr tabindex=[of.map(|_| 0)] data-from=[of.map(|of| format!("{:.3}", of.from_s))]
                            data-to=[of.map(|of| format!("{:.3}", of.to_s))] data-joint=[of.map(|of| clean(&of.joint))] {
                            @for (k, cell) in row.iter().enumerate() { td class=(class(k)) { (clean(cell)) } }
                        }
                    }
                }
            }
        }
    }
}
