//! The page of a plan.

use maud::{Markup, html};

use super::{
    choices::{Courses, choices},
    front::front,
    motion::{motion_charts, path},
    rows::limit_cell,
    tables::{document, judged_document},
};
use crate::{
    plan::PlanEvaluation,
    render::kit::{
        self, Document, Fact, Id, Sentence, counted, fact,
        page::{Chapter, Plots, card, choice::choice, headed, next_steps, scene::scene, verdict},
    },
    task::{Ceilings, Objective},
    workflow::plan::{Course, Options, PlanDocument, Planned},
};

pub(crate) fn page(
    plan: &PlanDocument,
    options: &Options,
    ceilings: &Ceilings,
    planned: &Planned,
    courses: &Courses<'_>,
) -> String {
    let algorithm = plan.algorithm.as_deref().unwrap_or_default();
    let mut document = document(&plan.title, algorithm, options, ceilings, planned);
    document.facts = facts(&planned.joints, algorithm, options, planned);
    let mut plots = Plots::default();
    let mut chapters = vec![
        Chapter { id: "summary", heading: "In short", body: summary(planned, courses.of_sample_arm) },
        Chapter { id: "front", heading: "The front", body: the_front(plan, planned, courses, &mut plots) },
    ];
    let shown = motion(&planned.joints, courses.chosen, courses.tool, &mut plots);
    chapters.push(Chapter { id: "motion", heading: "The motion that is shown", body: shown });
    chapters.push(numbers(&document));
    chapters.extend(Chapter::of(document.section(Id::REMARKS), "Remarks on the data"));
    kit::page::page("plan", &document, &chapters, &plots)
}

pub(crate) fn judged_page(
    title: &str,
    joints: &[String],
    (course, above): (&Course, &[(Objective, f64)]),
    tool: &str,
) -> String {
    let evaluation = &course.evaluation;
    let mut document = judged_document(title, joints, evaluation, above);
    document.facts = vec![fact("joints", joints.join(", "))];
    let mut plots = Plots::default();
    let cards = html! { div class="cards" { (limits(evaluation, joints)) (cost("The plan", evaluation)) } };
    let chapters = [
        Chapter { id: "summary", heading: "In short", body: cards },
        Chapter { id: "motion", heading: "The motion", body: motion(joints, course, tool, &mut plots) },
        numbers(&document),
    ];
    kit::page::page("plan", &document, &chapters, &plots)
}

/// The front, of which the reader chooses a plan.
fn the_front(plan: &PlanDocument, planned: &Planned, courses: &Courses<'_>, plots: &mut Plots) -> Markup {
    html! {
        (front(plan, plots))
        p class="hint" {
            "Click a point, or move the slider: first the chosen plan, then from the fastest on " (courses.of_front.len()) " of "
            (planned.front.len()) " plans. Numbers, motion and the line that makes the plan follow."
        }
        (choice("Plan shown", &choices(plan, planned, courses)))
    }
}

fn numbers(document: &Document) -> Chapter {
    let sections = document.sections.iter().filter(|section| section.id != Id::REMARKS);
    let body = html! { @for section in sections { (headed(section)) } };
    Chapter { id: "numbers", heading: "Numbers", body }
}

fn facts(joints: &[String], algorithm: &str, options: &Options, planned: &Planned) -> Vec<Fact> {
    let seed = options.search.seed;
    let search = format!("{algorithm}, seed {seed}, {} evaluations", planned.evaluations);
    vec![fact("joints", joints.join(", ")), fact("search", search)]
}

fn summary(planned: &Planned, of_sample_arm: bool) -> Markup {
    html! {
        div class="cards" {
            (limits(&planned.chosen, &planned.joints))
            (cost("Chosen", &planned.chosen))
            @for same in best(planned).chunk_by(|a, b| a.1.times_s == b.1.times_s && a.1.via == b.1.via) {
                (cost(&same.iter().map(|one| one.0.as_str()).collect::<Vec<_>>().join("; "), same[0].1))
            }
        }
        (next_steps(&next(planned, of_sample_arm)))
    }
}

/// The best plan of each objective, with what it is called.
fn best(planned: &Planned) -> Vec<(String, &PlanEvaluation)> {
    let named = |(objective, plan)| {
        let objective: &Objective = objective;
        (format!("{}, {}", objective.letter(), objective.row().best), plan)
    };
    Objective::OF_PLAN.iter().zip(&planned.best).map(named).collect()
}

/// Angle and speed of each joint over time, and the way of the tool.
fn motion(joints: &[String], course: &Course, tool: &str, plots: &mut Plots) -> Markup {
    html! {
        p class="hint" {
            "Numbered points are the key points, dashed lines limits that are near. Drag to zoom, all joints together."
        }
        div class="side" {
            @for (_, chart) in motion_charts(joints, course) { (plots.place(chart)) }
        }
        (scene(&path(&course.motion, &course.motion, tool)))
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

fn next(planned: &Planned, of_sample_arm: bool) -> Vec<(Sentence, Option<String>)> {
    let doubts = (!planned.remarks.is_empty()).then(|| {
        let doubts = counted(planned.remarks.as_slice().len(), "remark");
        format!("Check the task first: {doubts} below.")
    });
    let longer = (planned.fastest_converged == Some(false))
        .then(|| "Search longer (--evaluations): the fastest plan was still becoming faster.".to_owned());
    let tried = if of_sample_arm {
        "Try the chosen plan on a simulated arm: hydrotrace simulate PLAN -o RUN, then hydrotrace report RUN."
    } else {
        "Send the chosen plan as a table: hydrotrace export PLAN -o plan.csv."
    };
    let always = [
        "If another plan of the front suits better: --choose fastest, smoothest, knee, or --weights.",
        tried,
    ];
    let steps = doubts.into_iter().chain(longer).chain(always.map(str::to_owned));
    steps.map(|step| (Sentence::Advice(step), None)).collect()
}
