//! The page that answers "Safe to send?".

use maud::{Markup, html};

use super::{checks, joints, learning, tables};
use crate::{
    render::kit::{
        self, Document, Id, Section,
        page::{Chapter, Plots, blocks, card, headed},
    },
    workflow::replan::{Checks, Replanned, courses},
};

/// One page for the person who decides; `sending` holds the commands that come next.
pub(crate) fn page(replanned: &Replanned, sending: &Section) -> String {
    let mut document = tables::document(replanned);
    document.facts = tables::levers(replanned);
    let mut plots = Plots::default();
    let mut chapters = vec![
        Chapter { id: checks::ID.0, heading: "Safe to send?", body: answer(replanned, sending) },
        Chapter { id: "joints", heading: "Joints", body: drawn(replanned, &mut plots) },
    ];
    chapters.extend(Chapter::of(document.section(tables::EXPECTED), "Expected"));
    chapters.push(Chapter { id: Id::OTHER.0, heading: "Numbers", body: numbers(&document) });
    chapters.extend(Chapter::of(document.section(Id::REMARKS), "Remarks on the data"));
    kit::page::page("replan", &document, &chapters, &plots)
}

/// Verdict, checklist, commands.
fn answer(replanned: &Replanned, sending: &Section) -> Markup {
    let checks = Checks::of(replanned);
    let worst = checks.list.iter().map(|check| checks::mark(check.level)).max();
    let class = worst.map_or("", kit::Mark::class);
    let body = html! {
        @if let Some(advice) = learning::kept(replanned) { p { (kit::clean(&advice)) } }
        p { "Obstacles, people and what the machine did not show in its logs are not checked." }
    };
    html! {
        (card(class, "Verdict", &checks::verdict(&checks), &body))
        (blocks(&[checks::list(&checks, learning::units(replanned))]))
        (headed(sending))
    }
}

fn drawn(replanned: &Replanned, plots: &mut Plots) -> Markup {
    html! {
        p class="hint" {
            "Off plan: command and expected motion minus the plan. 90 % of starts stay within the shaded band. Dashed: limits that \
             are near. Drag to zoom, all joints together; double-click for the whole run."
        }
        div class="side" {
            @for course in courses(replanned) { (plots.place(joints::chart(&course))) }
        }
    }
}

fn numbers(document: &Document) -> Markup {
    html! {
        @for section in document.sections.iter().filter(|section| section.id == Id::OTHER) { (headed(section)) }
    }
}
