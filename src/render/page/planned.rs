//! The page of a plan.

use maud::{Markup, html};

use super::{
    chart::{Chart, Panel, Role, Series, Size, rounded},
    frame::{Plots, Section, document},
    front::front,
    parts::parts,
    run::remarks,
    summary::{card, verdict},
};
use crate::{
    plan::{PlanEvaluation, SampledMotion},
    remark::Remarks,
    render::{
        Part, counted,
        plan::{judged_parts, limit_cell, plan_parts},
    },
    task::Bounds,
    units::degrees_from_radians,
    workflow::{
        plan::front::Front,
        plan::{Options, Planned},
    },
};

/// What a search found, as one page.
pub fn plan_page(
    title: &str,
    algorithm: &str,
    options: &Options,
    bounds: &Bounds,
    planned: &Planned,
    course: &SampledMotion,
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
        Section {
            id: "motion",
            heading: "The chosen motion",
            body: motion(&planned.joints, course, &mut plots),
        },
        Section { id: "numbers", heading: "Numbers", body: parts(&list) },
    ];
    sections.extend(remarks(&planned.remarks));
    document("plan", title, &facts(&planned.joints, algorithm, options, planned), &sections, &plots)
}

/// One plan that was given, as one page.
pub fn judged_page(
    title: &str,
    joints: &[String],
    evaluation: &PlanEvaluation,
    course: &SampledMotion,
) -> String {
    let mut plots = Plots::default();
    let list: Vec<Part> = judged_parts(title, joints, evaluation);
    let sections = [
        Section {
            id: "summary",
            heading: "In short",
            body: html! { div class="cards" { (limits(evaluation, joints)) (cost("The plan", evaluation)) } },
        },
        Section { id: "motion", heading: "The motion", body: motion(joints, course, &mut plots) },
        Section { id: "numbers", heading: "Numbers", body: parts(&list) },
    ];
    let facts = [("joints".to_owned(), joints.join(", "))];
    document("plan", title, &facts, &sections, &plots)
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
        series: vec![Series { name: name.to_owned(), role, x: 0, y: degrees(values), names: Vec::new() }],
        share: 0.5,
        range: None,
    };
    Chart {
        title: joint.to_owned(),
        x_label: "Time (s)",
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
    verdict(&kept, &[line], "")
}

fn cost(label: &str, evaluation: &PlanEvaluation) -> Markup {
    let f = evaluation.objectives;
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
        steps.push(format!(
            "TerminalStyle at what is doubtful about the task: {} below.",
            doubts(&planned.remarks)
        ));
    }
    if planned.fastest_converged == Some(false) {
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
