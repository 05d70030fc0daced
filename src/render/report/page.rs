//! The page of one run.

use maud::{Markup, html};

use super::{
    frequency::frequency,
    joints::{joints, lags},
    summary::{concentration_bars, summary, titled},
    tables::document,
    tiles::transitions,
    together::Together,
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
            page::{Chapter, Plots, Shows, blocks, blocks_of, headed},
        },
        plan::front,
    },
    replay::Transition,
    workflow::report::{LateStart, Report},
};

/// What a run is called: its files.
pub(crate) fn name(report: &Report) -> String {
    report.logs.join(", ")
}

/// One page that answers the questions by itself; `most` is how many transitions its table lists, `read` the options with
/// which the log was read.
///
/// Whatever comes from the log is shown as text, whatever it looks like.
pub(crate) fn page(name: &str, report: &Report, fit: Option<&Fit>, most: usize, read: &[String]) -> String {
    let document = document(name, report, most);
    let mut plots = Plots::default();
    let mut chapters =
        vec![Chapter { id: "summary", heading: "In short", body: summary(report, read, &mut plots) }];
    let tool = tool_chapter(report, &mut plots, most);
    chapters.extend(tool.map(|body| Chapter { id: tool::ID.0, heading: "At the tool", body }));
    chapters.extend([
        Chapter { id: "joints", heading: "Joints", body: joints(report, &mut plots) },
        Chapter { id: "transitions", heading: "Transitions", body: transitions(report, &mut plots) },
        Chapter { id: "numbers", heading: "Numbers", body: numbers(&document, report) },
        Chapter { id: "lag", heading: "Lag", body: lags(report) },
        Chapter { id: "frequency", heading: "By frequency and speed", body: frequency(report, &mut plots) },
    ]);
    let late = document.section(why::ID).map(|section| blocks_of(&section.blocks, &late_starts(report)));
    chapters.extend(late.map(|body| Chapter { id: why::ID.0, heading: "Why late", body }));
    if let Some(fit) = fit {
        chapters.push(Chapter { id: "fit", heading: "Fitted machine", body: fitted(fit) });
    }
    // One plan is no choice.
    if let Some(found) = report.front.as_ref().filter(|found| found.front.len() > 1) {
        chapters.push(Chapter::new("front", "Plans to choose from", front(found, &mut plots)));
    }
    chapters.extend(Chapter::of(document.section(Id::REMARKS), "Remarks on the data"));
    chapters.extend(Chapter::of(document.section(Id::METHOD), "Source, method, thresholds"));
    kit::page::page("report", &document, &chapters, &plots)
}

fn numbers(document: &Document, report: &Report) -> Markup {
    html! {
        (blocks(document.blocks(Id::SUMMARY)))
        @for all in Together::all(&report.replay) {
            @if all.run.concentration.is_some() {
                h3 { (titled("Rms error inside and outside the transitions", &all)) }
                (concentration_bars(&all))
            }
        }
        @if let Some(section) = document.section(Id::JOINTS) { (headed(section)) }
        @if let Some(section) = document.section(Id::TRANSITIONS) {
            @if let Some(heading) = &section.heading { h3 { (heading) } }
            p class="hint" { "A row shows its start in the run; a heading sorts." }
            (blocks_of(&section.blocks, &transitions_shown(report)))
        }
    }
}

fn transitions_shown(report: &Report) -> Vec<Shows> {
    let of = |transition: &Transition| Shows::around(&transition.joint, transition.window_s);
    report.replay.worst_first().into_iter().map(of).collect()
}

fn late_starts(report: &Report) -> Vec<Shows> {
    let Some(Ok(why)) = &report.why else { return Vec::new() };
    let window = |start: &LateStart| [start.planned_onset_s, start.planned_onset_s + start.onset_delay_s];
    why::latest_first(why).into_iter().map(|start| Shows::around(&start.joint, window(start))).collect()
}
