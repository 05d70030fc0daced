//! The page of one run.

use maud::{Markup, html};

use super::{
    joints::{joints, lags},
    summary::{concentration_bars, summary},
    tables::document,
    tiles::transitions,
    tool,
    tool_page::tool_chapter,
    why,
};
use crate::{
    fit::Fit,
    render::{
        fit::fitted,
        kit::{
            self, Document, Id,
            page::{Chapter, Plots, blocks, headed},
        },
        plan::front,
    },
    workflow::report::Report,
};

/// What a run is called: its files.
pub(crate) fn name(report: &Report) -> String {
    report.logs.join(", ")
}

/// One page that answers the questions by itself; `most` is how many transitions its table lists.
///
/// Whatever comes from the log is shown as text, whatever it looks like.
pub(crate) fn page(name: &str, report: &Report, fit: Option<&Fit>, most: usize) -> String {
    let document = document(name, report, most);
    let mut plots = Plots::default();
    let mut chapters = vec![Chapter { id: "summary", heading: "In short", body: summary(report) }];
    let tool = tool_chapter(report, &mut plots, most);
    chapters.extend(tool.map(|body| Chapter { id: tool::ID.0, heading: "At the tool", body }));
    chapters.extend([
        Chapter { id: "joints", heading: "Joints", body: joints(report, &mut plots) },
        Chapter { id: "transitions", heading: "Transitions", body: transitions(report, &mut plots) },
        Chapter { id: "numbers", heading: "Numbers", body: numbers(&document, report) },
        Chapter { id: "lag", heading: "Lag", body: lags(report) },
    ]);
    chapters.extend(Chapter::of(document.section(why::ID), "Why late"));
    if let Some(fit) = fit {
        chapters.push(Chapter { id: "fit", heading: "Fitted machine", body: fitted(fit) });
    }
    // One plan is no choice.
    if let Some(found) = report.front.as_ref().filter(|found| found.front.len() > 1) {
        chapters.push(Chapter {
            id: "front",
            heading: "Plans to choose from",
            body: front(found, &mut plots),
        });
    }
    chapters.extend(Chapter::of(document.section(Id::REMARKS), "Remarks on the data"));
    chapters.extend(Chapter::of(document.section(Id::METHOD), "Source, method, thresholds"));
    kit::page::page("report", &document, &chapters, &plots)
}

fn numbers(document: &Document, report: &Report) -> Markup {
    html! {
        (blocks(document.blocks(Id::SUMMARY)))
        @if report.replay.whole_run.concentration.is_some() {
            h3 { "Rms error inside and outside the transitions" }
            (concentration_bars(report))
        }
        @for section in [Id::JOINTS, Id::TRANSITIONS].iter().filter_map(|id| document.section(*id)) {
            (headed(section))
        }
    }
}
