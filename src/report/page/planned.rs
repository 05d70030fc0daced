//! The page of a plan.

use maud::{Markup, html};

use super::{
    frame::{Plots, Section, document},
    front::front,
    parts::parts,
    run::remarks,
    summary::{card, verdict},
};
use crate::{
    remark::Remarks,
    report::{
        Part, counted,
        plan::{judged_parts, limit_cell, plan_parts},
    },
    task::Bounds,
    units::degrees_from_radians,
    workflow::{
        front::Front,
        plan::{Judged, Options, Planned},
    },
};

/// What a search found, as one page.
pub fn plan_page(
    title: &str,
    algorithm: &str,
    options: &Options,
    bounds: &Bounds,
    planned: &Planned,
) -> String {
    let mut plots = Plots::default();
    let found = Front::of(title, planned);
    let mut list = plan_parts(title, algorithm, options, bounds, planned);
    list.retain(|part| !matches!(part, Part::Title(_)));
    // Remarks have a section of their own.
    let own = list.iter().position(|part| matches!(part, Part::Heading(text) if text.starts_with("Remarks")));
    list.truncate(own.unwrap_or(list.len()));
    let mut sections = vec![
        Section { id: "summary", heading: "In short", body: summary(planned) },
        Section { id: "front", heading: "The front", body: front(&found, &mut plots) },
        Section { id: "numbers", heading: "Numbers", body: parts(&list) },
    ];
    sections.extend(remarks(&planned.remarks));
    document("plan", title, &facts(&planned.joints, algorithm, options, planned), &sections, &plots)
}

/// One plan that was given, as one page.
pub fn judged_page(title: &str, joints: &[String], judged: &Judged) -> String {
    let list: Vec<Part> = judged_parts(title, joints, judged);
    let sections = [
        Section {
            id: "summary",
            heading: "In short",
            body: html! { div class="cards" { (limits(judged, joints)) (cost("The plan", judged)) } },
        },
        Section { id: "numbers", heading: "Numbers", body: parts(&list) },
    ];
    let facts = [("joints".to_owned(), joints.join(", "))];
    document("plan", title, &facts, &sections, &Plots::default())
}

fn facts(joints: &[String], algorithm: &str, options: &Options, planned: &Planned) -> Vec<(String, String)> {
    let fact = |name: &str, value: String| (name.to_owned(), value);
    vec![
        fact("joints", joints.join(", ")),
        fact(
            "search",
            format!("{algorithm}, seed {}, {} evaluations", options.search.seed, planned.evaluations),
        ),
    ]
}

fn summary(planned: &Planned) -> Markup {
    let [a, b, c] = &planned.best;
    html! {
        div class="cards" {
            (limits(&planned.chosen, &planned.joints))
            (cost("Chosen", &planned.chosen))
            (cost("A, the fastest", a))
            (cost("B, the smoothest", b))
            (cost("C, of least power", c))
        }
        h3 { "What to do next" }
        ol class="next" { @for step in next(planned) { li { (step) } } }
    }
}

fn limits(judged: &Judged, joints: &[String]) -> Markup {
    let kept: Vec<bool> = judged.margins.iter().map(|margin| margin.share <= 1.0).collect();
    let line = format!("Nearest: {}", limit_cell(judged, joints));
    verdict(&kept, &[line], "")
}

fn cost(label: &str, judged: &Judged) -> Markup {
    let f = judged.objectives;
    let body = html! {
        p { (format!("RMS jerk {:.4} deg/s3", degrees_from_radians(f.rms_jerk_rad_s3))) }
        p { (format!("RMS power {:.2} W", f.rms_power_w)) }
    };
    card("", label, &format!("{:.2} s", f.duration_s), &body)
}

fn next(planned: &Planned) -> Vec<String> {
    let doubts = |remarks: &Remarks| counted(remarks.as_slice().len(), "remark");
    let mut steps = Vec::new();
    if !planned.remarks.is_empty() {
        steps.push(format!("Look at what is doubtful about the task: {} below.", doubts(&planned.remarks)));
    }
    if planned.hasty == Some(true) {
        steps.push("Search longer (--evaluations): the fastest plan was still getting faster.".to_owned());
    }
    steps.push(
        "Another plan of the front may suit better: --choose fastest, smoothest, knee, or --weights."
            .to_owned(),
    );
    steps.push(
        "Try the chosen plan on a simulated arm: hydrotrace simulate PLAN -o RUN, then report RUN."
            .to_owned(),
    );
    steps
}
