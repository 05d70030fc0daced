//! Plans of the front of which the reader chooses one.

use std::path::Path;

use super::{
    broken::over_ceilings,
    motion::{motion_charts, path},
    tables::nearest_lines,
};
use crate::{
    render::kit::{argument, command, page::choice::Choice},
    task::{Ceilings, Objective},
    workflow::plan::{Course, PlanDocument, Planned},
};

/// The motions behind a page.
pub(crate) struct Courses<'a> {
    /// The chosen plan's.
    pub(crate) chosen: &'a Course,
    /// Those of plans of the front, with their places in it.
    pub(crate) of_front: &'a [(usize, Course)],
    pub(crate) tool: &'a str,
    pub(crate) ceilings: &'a Ceilings,
    /// Whether the machines that `simulate` knows by name have its joints.
    pub(crate) of_sample_arm: bool,
    /// The task's file as the caller named it.
    pub(crate) task: &'a Path,
}

/// The chosen plan, then those of the front, the fastest first.
pub(super) fn choices(plan: &PlanDocument, planned: &Planned, courses: &Courses<'_>) -> Vec<Choice> {
    let of = |name: String, point: [usize; 2], course: &Course| one(name, point, course, planned, courses);
    let mut chosen = of("chosen".to_owned(), [1, plan.best().count()], courses.chosen);
    if !courses.chosen.evaluation.via.is_empty() {
        chosen.command.clear();
        chosen
            .lines
            .push("Its shape is free: no times alone make it; `-o` of the search writes it.".to_owned());
    }
    let count = planned.front.len();
    let others = courses.of_front.iter().map(|(place, course)| {
        of(format!("plan {} of {count} on the front", place + 1), [0, *place], course)
    });
    std::iter::once(chosen).chain(others).collect()
}

fn one(name: String, point: [usize; 2], course: &Course, planned: &Planned, courses: &Courses<'_>) -> Choice {
    let evaluation = &course.evaluation;
    // All digits: a plan on its limit breaks it by what rounding takes.
    let times: Vec<String> = evaluation.times_s.iter().map(f64::to_string).collect();
    let words = ["plan", &argument(courses.task), "--times", &times.join(","), "-o", "plan.mcap"];
    let costs =
        Objective::OF_PLAN.iter().map(|k| format!("{} {}", k.row().name, k.text(evaluation.objectives[*k])));
    let arrivals: Vec<String> = evaluation.times_s.iter().map(|t_s| format!("{t_s:.2}")).collect();
    let arrivals = format!("arrives at {} s", arrivals.join(", "));
    let lines = costs
        .chain([arrivals])
        .chain(over_ceilings(courses.ceilings, evaluation))
        .chain(nearest_lines(evaluation, &planned.joints));
    let scene = path(&course.motion, &courses.chosen.motion, courses.tool);
    Choice {
        name,
        lines: lines.collect(),
        command: command(&words),
        point,
        charts: motion_charts(&planned.joints, course).into_iter().map(|(_, chart)| chart).collect(),
        path: scene.measured,
        value: scene.value,
    }
}
