//! The page of a plan.

use maud::{Markup, html};

use super::{
    front::front,
    tables::{document, judged_document, limit_cell},
};
use crate::{
    plan::{PlanEvaluation, SampledMotion},
    render::kit::{
        self, Document, Fact, Id, Sentence, counted, fact,
        page::{
            Chapter, Plots, card,
            chart::{Chart, Panel, Role, Series, Size, rounded},
            headed, next_steps, verdict,
        },
    },
    task::{Ceilings, Objective},
    units::degrees_from_radians,
    workflow::plan::{Options, PlanDocument, Planned},
};

/// What a search found, as one page.
pub(crate) fn page(
    plan: &PlanDocument,
    options: &Options,
    ceilings: &Ceilings,
    planned: &Planned,
    course: &SampledMotion,
) -> String {
    let algorithm = plan.algorithm.as_deref().unwrap_or_default();
    let mut document = document(&plan.title, algorithm, options, ceilings, planned);
    document.facts = facts(&planned.joints, algorithm, options, planned);
    let mut plots = Plots::default();
    let mut chapters = vec![
        Chapter { id: "summary", heading: "In short", body: summary(planned) },
        Chapter { id: "front", heading: "The front", body: front(plan, &mut plots) },
        Chapter {
            id: "motion",
            heading: "The chosen motion",
            body: motion(&planned.joints, course, &mut plots),
        },
        numbers(&document),
    ];
    chapters.extend(Chapter::of(document.section(Id::REMARKS), "Remarks on the data"));
    kit::page::page("plan", &document, &chapters, &plots)
}

/// One plan that was given, as one page.
pub(crate) fn judged_page(
    title: &str,
    joints: &[String],
    evaluation: &PlanEvaluation,
    course: &SampledMotion,
) -> String {
    let mut document = judged_document(title, joints, evaluation);
    document.facts = vec![fact("joints", joints.join(", "))];
    let mut plots = Plots::default();
    let chapters = [
        Chapter {
            id: "summary",
            heading: "In short",
            body: html! { div class="cards" { (limits(evaluation, joints)) (cost("The plan", evaluation)) } },
        },
        Chapter { id: "motion", heading: "The motion", body: motion(joints, course, &mut plots) },
        numbers(&document),
    ];
    kit::page::page("plan", &document, &chapters, &plots)
}

fn numbers(document: &Document) -> Chapter {
    let sections = document.sections.iter().filter(|section| section.id != Id::REMARKS);
    let body = html! { @for section in sections { (headed(section)) } };
    Chapter { id: "numbers", heading: "Numbers", body }
}

fn facts(joints: &[String], algorithm: &str, options: &Options, planned: &Planned) -> Vec<Fact> {
    vec![
        fact("joints", joints.join(", ")),
        fact(
            "search",
            format!("{algorithm}, seed {}, {} evaluations", options.search.seed, planned.evaluations),
        ),
    ]
}

fn summary(planned: &Planned) -> Markup {
    html! {
        div class="cards" {
            (limits(&planned.chosen, &planned.joints))
            (cost("Chosen", &planned.chosen))
            @for (objective, plan) in Objective::OF_PLAN.iter().zip(&planned.best) {
                (cost(&format!("{}, {}", objective.letter(), objective.row().best), plan))
            }
        }
        (next_steps(&next(planned)))
    }
}

/// Angle and speed of each joint over time.
fn motion(joints: &[String], course: &SampledMotion, plots: &mut Plots) -> Markup {
    let arrivals: Vec<String> = course.arrivals_s.iter().map(|t_s| format!("{t_s:.2}")).collect();
    html! {
        p class="hint" { "Key points are reached at " (arrivals.join(", ")) " s. Drag to zoom, all joints together." }
        div class="side" {
            @for (_, chart) in motion_charts(joints, course) { (plots.place(chart)) }
        }
    }
}

/// Joints with their angles and speeds.
pub(super) fn motion_charts(joints: &[String], course: &SampledMotion) -> Vec<(String, Chart)> {
    let motions = course.position_rad.iter().zip(&course.velocity_rad_s);
    let chart = |(joint, (angle, speed)): (&String, (&Vec<f64>, &Vec<f64>))| {
        (joint.clone(), joint_motion(joint, &course.t_s, angle, speed))
    };
    joints.iter().zip(motions).map(chart).collect()
}

fn joint_motion(joint: &str, t_s: &[f64], angle_rad: &[f64], speed_rad_s: &[f64]) -> Chart {
    let degrees =
        |values: &[f64]| values.iter().map(|v| rounded(degrees_from_radians(*v))).collect::<Vec<f64>>();
    let panel = |label: &str, name: &str, role, values: &[f64]| Panel {
        label: label.to_owned(),
        series: vec![Series::of(name, role, 0, degrees(values))],
        share: 0.5,
        range: None,
    };
    Chart {
        title: joint.to_owned(),
        x_label: "Time (s)".into(),
        xs: vec![t_s.iter().copied().map(rounded).collect()],
        panels: vec![
            panel("Angle (deg)", "angle", Role::Measured, angle_rad),
            panel("Speed (deg/s)", "speed", Role::Error, speed_rad_s),
        ],
        group: Some("run"),
        height: 230,
        size: Size::Half,
        ..Chart::default()
    }
}

fn limits(evaluation: &PlanEvaluation, joints: &[String]) -> Markup {
    let kept: Vec<bool> = evaluation.margins.iter().map(|margin| !margin.broken()).collect();
    let line = format!("Nearest: {}", limit_cell(evaluation, joints));
    verdict(&kept, &[line])
}

fn cost(label: &str, evaluation: &PlanEvaluation) -> Markup {
    let text = |k: Objective| k.text(evaluation.objectives[k]);
    let (first, others) = Objective::OF_PLAN.split_first().unwrap_or((&Objective::Duration, &[]));
    let body = html! { @for k in others { p { (k.row().name) " " (text(*k)) } } };
    card("", label, &text(*first), &body)
}

fn next(planned: &Planned) -> Vec<(Sentence, Option<String>)> {
    let doubts = (!planned.remarks.is_empty()).then(|| {
        let doubts = counted(planned.remarks.as_slice().len(), "remark");
        format!("Check the task first: {doubts} below.")
    });
    let longer = (planned.fastest_converged == Some(false))
        .then(|| "Search longer (--evaluations): the fastest plan was still becoming faster.".to_owned());
    let always = [
        "If another plan of the front suits better: --choose fastest, smoothest, knee, or --weights.",
        "Try the chosen plan on a simulated arm: hydrotrace simulate PLAN -o RUN, then hydrotrace report RUN.",
    ];
    let steps = doubts.into_iter().chain(longer).chain(always.map(str::to_owned));
    steps.map(|step| (Sentence::Advice(step), None)).collect()
}
