//! Blocks of a document as HTML.

use maud::{Markup, html};

use crate::render::kit::{Align, Block, Check, Fact, Section, Table, clean};

pub(in crate::render) fn headed(section: &Section) -> Markup {
    html! {
        @if let Some(heading) = &section.heading { h3 { (clean(heading)) } }
        (blocks(&section.blocks))
    }
}

pub(in crate::render) fn blocks(blocks: &[Block]) -> Markup {
    blocks_of(blocks, &[])
}

/// The same; rows of tables show their stretches in the plots of the run.
pub(in crate::render) fn blocks_of(blocks: &[Block], shows: &[Shows]) -> Markup {
    html! {
        @for block in blocks {
            @match block {
                Block::Sentence(sentence) => { p { (clean(&sentence.to_string())) } }
                Block::Facts(facts) => { (list(facts)) }
                Block::Remarks(facts) => { div class="remarks" { (list(facts)) } }
                Block::Checks(checks) => { (checked(checks)) }
                Block::Table(whole) => { (table_of(whole, shows)) }
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

/// What a click shows in the plots of the run: the attributes of an element, `data-from`, `data-to` and `data-joint`.
#[derive(Debug, Clone)]
pub(in crate::render) struct Shows {
    pub(in crate::render) from: String,
    pub(in crate::render) to: String,
    pub(in crate::render) joint: String,
}

impl Shows {
    /// A stretch of a joint, s, with a little of what lies beside it.
    pub(in crate::render) fn around(joint: &str, [from_s, to_s]: [f64; 2]) -> Self {
        const BESIDE_S: f64 = 0.5;
        let fixed = |s: f64| format!("{s:.3}");
        Self { from: fixed(from_s - BESIDE_S), to: fixed(to_s + BESIDE_S), joint: clean(joint) }
    }
}

/// A table that scrolls by itself where the screen is narrow.
pub(in crate::render) fn table(table: &Table) -> Markup {
    table_of(table, &[])
}

/// What a cell is sorted by that is no number and yet more than each.
fn later_than_any(cell: &str) -> Option<&'static str> {
    (cell == "never").then_some("Infinity")
}

fn table_of(table: &Table, shows: &[Shows]) -> Markup {
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
                        @let of = shows.get(n);
                        tr tabindex=[of.map(|_| 0)] data-from=[of.map(|of| &of.from)] data-to=[of.map(|of| &of.to)]
                            data-joint=[of.map(|of| &of.joint)] {
                            @for (k, cell) in row.iter().enumerate() {
                                td class=(class(k)) data-sort=[later_than_any(cell)] { (clean(cell)) }
                            }
                        }
                    }
                }
            }
        }
    }
}
