//! The page of one run.

use maud::{Markup, html};

use super::{
    fitted::fitted,
    frame::{Plots, Section, document},
    front::front,
    joints::{joints, lags},
    parts::parts,
    summary::{concentration_bars, summary},
    transitions::transitions,
};
use crate::{
    fit::Fit,
    render::{
        Part,
        method::method_parts,
        tables::{in_short, joint_parts, remark_parts, source_facts, transition_parts},
    },
    workflow::report::Report,
};

/// One page that answers the questions by itself; `most` is how many transitions its table lists.
///
/// Whatever comes from the log is shown as text, whatever it looks like.
pub fn report_page(name: &str, report: &Report, fit: Option<&Fit>, most: usize) -> String {
    let mut plots = Plots::default();
    let mut sections = vec![
        Section { id: "summary", heading: "In short", body: summary(report) },
        Section { id: "joints", heading: "Joints", body: joints(report, &mut plots) },
        Section { id: "transitions", heading: "Transitions", body: transitions(report, &mut plots) },
        Section { id: "numbers", heading: "Numbers", body: numbers(report, most) },
        Section { id: "lag", heading: "Lag", body: lags(report) },
    ];
    if let Some(fit) = fit {
        sections.push(Section { id: "fit", heading: "Fitted machine", body: fitted(fit) });
    }
    if let Some(found) = &report.front {
        sections.push(Section {
            id: "front",
            heading: "Plans to choose from",
            body: front(found, &mut plots),
        });
    }
    sections.extend(remarks(&report.remarks));
    let mut method = Vec::new();
    method_parts(report, &mut method);
    method.retain(|part| !matches!(part, Part::Heading(_)));
    sections.push(Section { id: "method", heading: "Source, method, thresholds", body: parts(&method) });
    document("report", name, &source_facts(report), &sections, &plots)
}

/// The doubts, if there are any.
pub(super) fn remarks(remarks: &crate::remark::Remarks) -> Option<Section> {
    let mut list = Vec::new();
    remark_parts(remarks, &mut list);
    list.retain(|part| !matches!(part, Part::Heading(_)));
    let body = html! { div class="remarks" { (parts(&list)) } };
    (!list.is_empty()).then_some(Section { id: "remarks", heading: "Remarks on the data", body })
}

fn numbers(report: &Report, most: usize) -> Markup {
    let lines: Vec<Part> = in_short(report).into_iter().map(Part::Line).collect();
    let mut tables = Vec::new();
    joint_parts(&report.replay, &report.profiles, &mut tables);
    transition_parts(&report.replay, most, &mut tables);
    html! {
        (parts(&lines))
        @if report.replay.whole_run.concentration.is_some() {
            h3 { "Rms error inside and outside the transitions" }
            (concentration_bars(report))
        }
        (parts(&tables))
    }
}
